// Scenes as data: objects, named cameras and camera paths, and loading them as hierarchies, meshes or HLODs. The file
// format is described in docs/guide/scenes.md.
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

// A mesh or .olod file. The first of these names counts that is found beside the scene file, in the folders of the
// environment variable OCCLOD_MESHES (separated by ':') or in the user's mesh folder (where scripts put the meshes of
// system packages).
struct MeshFile {
  std::vector<std::string> names;  // relative to these folders, or absolute; UTF-8
};

// A mesh that generate() makes of these arguments.
struct GeneratedMesh {
  std::string generator;   // one of generators()
  GeneratorValues values;  // of its parameters
};

// Where the mesh of an object comes from.
using MeshSource = std::variant<MeshFile, GeneratedMesh>;

// One placed mesh.
struct SceneObject {
  MeshSource source;                // file or generator
  glm::dmat4 object_to_world{1.0};  // affine, invertible
  bool two_sided = false;           // back faces are visible too
  bool attributes = true;           // shifts of texture coordinates, normals and colours count as errors, as
                                    // RefineObject::attributes says
};

// A camera that moves.
struct CameraPath {
  std::vector<Camera> keys;  // at least one; with `jump` at most as many as frames, without it all of one projection
  int frames = 1;            // >= 1
  bool jump = false;         // each key is held for its share of the frames, without interpolation between keys
};

// Where the eye may be, and the defaults for building view cells there.
struct SceneCells {
  std::vector<CellBox> regions;         // world space, at least one, min <= max; they may overlap
  std::optional<double> root_cell;      // edge of the largest cells, world units, > 0
  std::optional<double> smallest_cell;  // edge below which no cell is divided, world units, > 0; at most root_cell
  std::optional<std::uint64_t> max_triangles;  // a cell that draws more is divided, >= 1
};

// A scene as its file describes it.
struct SceneDescription {
  std::string name;                         // name of the file without its extension
  std::filesystem::path file;               // the file from which it was read, for messages; empty when a program made
                                            // it
  std::string about;                        // one sentence for people; may be empty
  std::vector<SceneObject> objects;         // at least one
  std::map<std::string, Camera> cameras;    // by name; "default" is always there
  std::map<std::string, CameraPath> paths;  // by name
  std::optional<SceneCells> cells;          // when the scene has them
};

// Reads a scene file and checks what can be checked without loading its meshes: types, ranges of placements and
// cameras, and that every frame of a path has a view. Unknown, repeated and missing keys are mistakes too. Throws Error
// that names the file and the JSON path of the mistake.
[[nodiscard]] SceneDescription read_scene(const std::filesystem::path& path);

// True when the extension is .json, in upper or lower case.
[[nodiscard]] bool is_scene_file(const std::filesystem::path& path);

// Reads a scene file as read_scene() does; takes any other file for a mesh or a hierarchy and returns a scene of that
// one object, without cameras. Throws Error, also for a folder.
[[nodiscard]] SceneDescription describe_file(const std::filesystem::path& path);

// Writes a file from which read_scene() reads the same numbers: placements as matrices, all fields of each camera.
// Writes beside `path` and renames. Throws Error for a scene without objects or without the camera "default", and when
// the file cannot be written.
void write_scene(const std::filesystem::path& path, const SceneDescription& scene);

// Returns the camera of frame i of a path, 0 <= i < frames. Keys are spread evenly over the frames; eyes, targets,
// angles, ranges and up directions are interpolated linearly between them. With `jump` the camera is key floor(i * keys
// / frames), unchanged. The image size is the first key's.
[[nodiscard]] Camera camera_at(const CameraPath& path, int frame);

// Options of load_objects() and load_hlods().
struct LoadOptions {
  BuildOptions build = {};                 // for hierarchies that have to be built
  hlod::HlodBuildOptions build_hlod = {};  // for an HLOD that has to be built
  // When set, load_hlods() opens .ohlod files by open_ohlod(), and their meshes are paged. The budget is shared equally
  // by all files. Objects that are not .ohlod files are then an error.
  std::optional<hlod::CacheOptions> paged = {};
  // Keeps what was built in ${XDG_CACHE_HOME:-~/.cache}/occlod under a hash of the input's bytes, the options and the
  // builder's sources.
  bool use_cache = true;
  // Called with the current step and the share of it that is done, in [0, 1]; an exception that it throws ends the
  // loading.
  std::function<void(const std::string& what, double done)> progress = {};
  // Receives one line when a cache cannot be used; what is asked for is built all the same.
  std::function<void(const std::string& line)> note = {};
};

// One object, ready to be refined.
struct LoadedObject {
  std::shared_ptr<const Hierarchy> hierarchy;  // shared by objects with the same source
  glm::dmat4 object_to_world{1.0};             // of its positions: as in the scene, after a move by its origin
  bool two_sided = false;                      // as in the scene
  std::string source_name;                     // file or generator, for people
  bool attributes = true;                      // as in the scene
};

// Reads or generates the meshes, and builds their hierarchies or fetches them from the cache; objects come in the order
// of the scene. Relative names start in `folder`, the folder of the scene file. Throws Error for what is missing,
// cannot be read or cannot be built.
[[nodiscard]] std::vector<LoadedObject> load_objects(const SceneDescription& scene, const std::filesystem::path& folder,
                                                     const LoadOptions& options = {});

// Returns all objects as one clean mesh in world space, with an origin where floats would lose digits. Triangles of
// mirrored objects are reversed, so that outsides stay outside, and vertices of different objects at one position
// become one. Normals and colours are kept when every object has them, texture coordinates and materials when any has;
// objects without them get (0, 0) and a plain material. Names of images become relative to `folder`, or absolute for
// images elsewhere. The report counts what the meshes left out. Mesh files are read in full, hierarchies at their
// finest. `progress` is as in LoadOptions. Throws Error as load_objects() does, and when all objects together have 2^32
// vertices or more, or reach too far. O(size of all objects).
[[nodiscard]] CleanMesh flatten_scene(const SceneDescription& scene, const std::filesystem::path& folder,
                                      const std::function<void(const std::string& what, double done)>& progress = {});

// Returns the triangles of flatten_scene() for build_hlod(), one mesh at a time. PLY and OBJ files are read block by
// block into arrays that a MemoryLimit keeps in scratch files, and only once for consecutive copies of a mesh;
// generated meshes are made piece by piece; other files are in memory as a whole. Failures are thrown as Error while
// triangles are given. `progress` is called on the thread that asks for triangles.
[[nodiscard]] hlod::TriangleSource stream_scene(
    SceneDescription scene, std::filesystem::path folder,
    std::function<void(const std::string& what, double done)> progress = {});

// Returns the path at which a mesh of this name is found, in the folders that MeshFile describes, or an empty path. An
// absolute name is only looked up as it is.
[[nodiscard]] std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& folder);

// A mesh and its placement.
struct PlacedMesh {
  const TriangleMesh* mesh = nullptr;  // valid, see TriangleMesh; must outlive the call
  glm::dmat4 object_to_world{1.0};     // of its positions, see positions_to_world(); affine, invertible
  std::string source_name;             // its file or generator; names of images start in the file's folder, and meshes
                                       // with one source name share their materials
};

// Joins meshes into one in world space, with an origin where floats would lose digits; vertices and wedges of different
// meshes stay separate. Triangles of mirrored objects are reversed, so that outsides stay outside. Normals and colours
// are kept when every mesh has them, texture coordinates and materials when any has; meshes without them get (0, 0) and
// a plain material. Names of images become relative to `folder`, in which the result is to be written, or absolute for
// images elsewhere. Throws Error with `name` as its subject when all meshes together have 2^32 wedges or more, or more
// than 65,535 materials or textures. O(size of all).
[[nodiscard]] TriangleMesh join_meshes(std::span<const PlacedMesh> meshes, const std::filesystem::path& folder,
                                       const std::string& name);

// One HLOD, ready to be drawn.
struct LoadedHlod {
  std::shared_ptr<const hlod::Hlod> hlod;  // shared by objects with the same file; all its meshes have been checked or
                                           // are in a store
  glm::dmat4 object_to_world{1.0};         // of its positions: as in the scene, or the identity where objects were
                                           // flattened, after a move by its origin
  bool two_sided = false;                  // as in the scene; where objects were flattened, true if any of them is
                                           // two-sided
  std::string source_name;                 // the file or, where objects were flattened, the scene
};

// Builds one HLOD of flatten_scene() from all objects that are not .ohlod files, or fetches it from the cache; it comes
// first, then each .ohlod file in the order of the scene. `folder` is as in load_objects(). Throws Error as
// flatten_scene(), read_ohlod() and open_ohlod() do, and for a mesh without triangles.
[[nodiscard]] std::vector<LoadedHlod> load_hlods(const SceneDescription& scene, const std::filesystem::path& folder,
                                                 const LoadOptions& options = {});

}  // namespace occlod
