// Scenes as data: objects, named cameras and camera paths. The file format is described in docs/guide/scenes.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/mat4x4.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "occlod/build_hierarchy.h"
#include "occlod/build_hlod.h"
#include "occlod/cell_builder.h"
#include "occlod/generate.h"
#include "occlod/hierarchy.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"
#include "occlod/node_store.h"
#include "occlod/view.h"

namespace occlod {

// A mesh or .olod file: the first of these names that is found beside the scene file, in the folders of the environment
// variable OCCLOD_MESHES (separated by ':') or in the user's mesh folder (where scripts put the meshes of system
// packages).
struct MeshFile {
  std::vector<std::string> names;  // relative to these folders, or absolute; UTF-8
};

// Where the mesh of an object comes from: a file or a generator.
using MeshSource =
    std::variant<MeshFile, RoughPlanetOptions, CityOptions, PipesOptions, PlantOptions, SpheresBehindWallOptions>;

// One placed mesh.
struct SceneObject {
  MeshSource source;                // file or generator
  glm::dmat4 object_to_world{1.0};  // affine, invertible
  bool two_sided = false;           // back faces are visible too
  bool attributes = true;  // how far textures, normals and colours slip counts as an error: RefineObject has it
};

// A camera that moves.
struct CameraPath {
  std::vector<Camera> keys;  // at least one; with `jump` at most as many as frames, without it all of one projection
  int frames = 1;            // >= 1
  bool jump = false;         // each key is held for its share of the frames, without moving between keys
};

// Where the eye may be, and how view cells are made there unless somebody says otherwise.
struct SceneCells {
  std::vector<CellBox> regions;         // world space, at least one, min <= max; they may overlap
  std::optional<double> root_cell;      // edge of the largest cells, world units, > 0
  std::optional<double> smallest_cell;  // edge below which no cell is divided, world units, > 0; at most root_cell
  std::optional<std::uint64_t> max_triangles;  // a cell that draws more is divided, >= 1
};

// A scene as its file says it.
struct SceneDescription {
  std::string name;                         // of the file, without its extension
  std::filesystem::path file;               // that it was read from, for messages; empty where a program made it
  std::string about;                        // one sentence for people; may be empty
  std::vector<SceneObject> objects;         // at least one
  std::map<std::string, Camera> cameras;    // by name; "default" is always there
  std::map<std::string, CameraPath> paths;  // by name
  std::optional<SceneCells> cells;          // where the scene says it
};

// Reads a scene file and checks what can be checked without loading its meshes: types, ranges of placements and
// cameras, and that every frame of a path has a view. Unknown, repeated and missing keys are mistakes too. Throws Error
// that names the file and the JSON path of the mistake.
[[nodiscard]] SceneDescription read_scene(const std::filesystem::path& path);

// Whether the extension is .json, whatever its case.
[[nodiscard]] bool is_scene_file(const std::filesystem::path& path);

// Reads a scene file as read_scene() does. Any other file is taken for a mesh or a hierarchy and gives a scene of that
// one object without cameras. Throws Error, also for a folder.
[[nodiscard]] SceneDescription describe_file(const std::filesystem::path& path);

// Writes a file from which read_scene() reads the same numbers back: placements as matrices, all fields of each camera.
// Writes beside `path` and renames. Throws Error for a scene without objects or without the camera "default", and when
// the file cannot be written.
void write_scene(const std::filesystem::path& path, const SceneDescription& scene);

// The camera of frame i of a path, 0 <= i < frames. Keys are spread evenly over the frames; eyes, targets, angles,
// ranges and up directions are interpolated linearly between them. With `jump` it is key floor(i * keys / frames) as it
// is. The image size is the first key's.
[[nodiscard]] Camera camera_at(const CameraPath& path, int frame);

// How objects are loaded.
struct LoadOptions {
  BuildOptions build = {};  // of hierarchies that have to be built
  // Keep hierarchies in ${XDG_CACHE_HOME:-~/.cache}/occlod under a hash of the input's bytes, the options and the
  // builder's sources.
  bool use_cache = true;
  // Called with what is being done and the share of it that is done, in [0, 1]; what it throws ends the loading.
  std::function<void(const std::string& what, double done)> progress = {};
  // Told in one line of a cache that cannot be used; the hierarchy is built all the same.
  std::function<void(const std::string& line)> note = {};
};

// One object, ready to be refined.
struct LoadedObject {
  std::shared_ptr<const Hierarchy> hierarchy;  // shared by objects with the same source
  glm::dmat4 object_to_world{1.0};             // as in the scene
  bool two_sided = false;                      // as in the scene
  std::string source_name;                     // file or generator, for people
  bool attributes = true;                      // as in the scene
};

// Reads or generates the meshes and builds their hierarchies or fetches them from the cache; objects come in the order
// of the scene. `folder`: of the scene file, where relative names start. Throws Error for what is missing, cannot be
// read or cannot be built.
[[nodiscard]] std::vector<LoadedObject> load_objects(const SceneDescription& scene, const std::filesystem::path& folder,
                                                     const LoadOptions& options = {});

// All objects as one clean mesh in world space: triangles of mirrored objects are turned round, so that outsides stay
// outside, and vertices of different objects at one position become one. Normals and colours are kept when every object
// has them, texture coordinates and materials when any has: the others lie at (0, 0) and are plain. Names of images
// become relative to `folder`, or absolute where they lie elsewhere. The report counts what the meshes left out. Files
// are read in full, hierarchies at their finest. `progress` as in LoadOptions. Throws Error as load_objects() does, and
// when all together have 2^32 vertices or more, or reach too far. O(size of all objects).
[[nodiscard]] CleanMesh flatten_scene(const SceneDescription& scene, const std::filesystem::path& folder,
                                      const std::function<void(const std::string& what, double done)>& progress = {});

// The triangles of flatten_scene() for build_hlod(), one mesh at a time. PLY and OBJ files are read block by block into
// arrays that a MemoryLimit keeps in scratch files, and once where copies follow each other; generated meshes are made
// piece by piece; other files are in memory as a whole. What fails is thrown as Error while they are given. `progress`
// is called on the thread that asks.
[[nodiscard]] hlod::TriangleSource stream_scene(
    SceneDescription scene, std::filesystem::path folder,
    std::function<void(const std::string& what, double done)> progress = {});

// Where a mesh of this name is found, searched for as MeshFile says, or an empty path. An absolute name is only looked
// up as it is.
[[nodiscard]] std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& folder);

// Several meshes at their places as one mesh.

// One mesh and where it stands.
struct PlacedMesh {
  const TriangleMesh* mesh = nullptr;  // valid, see TriangleMesh; must outlive the call
  glm::dmat4 object_to_world{1.0};     // affine, invertible
  std::string source_name;             // its file or generator: names of images start in the file's folder, and meshes
                                       // of one name share their materials
};

// All of them as one in world space, vertices and wedges apart as they were: triangles of mirrored objects are turned
// round, so that outsides stay outside. Normals and colours are kept when every mesh has them, texture coordinates and
// materials when any has: the others lie at (0, 0) and are plain. Names of images become relative to `folder`, where
// the result is to be written, or absolute where they lie elsewhere. Throws Error that says `name` when all together
// have 2^32 wedges or more, or more than 65,535 materials or textures. O(size of all).
[[nodiscard]] TriangleMesh join_meshes(std::span<const PlacedMesh> meshes, const std::filesystem::path& folder,
                                       const std::string& name);

// Scenes as HLODs: built from all objects together, or read from .ohlod files.

// How HLODs are loaded.
struct HlodLoadOptions {
  hlod::BuildOptions build = {};  // of an HLOD that has to be built
  bool use_cache = true;          // as LoadOptions::use_cache
  // .ohlod files are opened by open_ohlod(): their meshes come and go. The budget is that of all files together, each
  // has an equal share. Objects that are no .ohlod files are an error then.
  std::optional<hlod::CacheOptions> paged = {};
  // As LoadOptions::progress.
  std::function<void(const std::string& what, double done)> progress = {};
  // As LoadOptions::note.
  std::function<void(const std::string& line)> note = {};
};

// One HLOD, ready to be drawn.
struct LoadedHlod {
  std::shared_ptr<const hlod::Hlod> hlod;  // shared by objects with the same file; all its meshes have been checked or
                                           // are in a store
  glm::dmat4 object_to_world{1.0};         // as in the scene; none where objects were flattened
  bool two_sided = false;                  // as in the scene; where objects were flattened, of any of them
  std::string source_name;                 // the file or, where objects were flattened, the scene
};

// All objects that are no .ohlod files as one HLOD of flatten_scene(), fetched from the cache or built, then each
// .ohlod file where the scene has it. `folder` as in load_objects(). Throws Error as flatten_scene(), read_ohlod()
// and open_ohlod() do, and for a mesh without triangles.
[[nodiscard]] std::vector<LoadedHlod> load_hlods(const SceneDescription& scene, const std::filesystem::path& folder,
                                                 const HlodLoadOptions& options = {});

}  // namespace occlod
