// Scenes as data: objects, named cameras and camera paths. The file format is described in docs/guide/scenes.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/mat4x4.hpp>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "occlod/hierarchy/build.h"
#include "occlod/hierarchy/hierarchy.h"
#include "occlod/mesh/generate.h"
#include "occlod/mesh/mesh_report.h"
#include "occlod/view/camera.h"

namespace occlod {

// A mesh or .olod file: the first of these names that is found, beside the scene file, in the folders of the
// environment variable OCCLOD_MESHES (separated by ':'), or in the user's mesh folder (where scripts put the meshes of
// system packages).
struct MeshFile {
  std::vector<std::string> names;
};

using MeshSource = std::variant<MeshFile, RoughPlanetOptions, CityOptions, PipesOptions, SpheresBehindWallOptions>;

struct SceneObject {
  MeshSource source;
  glm::dmat4 object_to_world{1.0};
  bool two_sided = false;
};

struct CameraPath {
  std::vector<Camera> keys;  // at least one; with `jump` at most as many as frames, without all of one projection
  int frames = 1;
  bool jump = false;  // every key is held for its share of the frames instead of moving on to the next
};

struct SceneDescription {
  std::string name;
  std::filesystem::path file;  // that it was read from, for messages; empty where a program made it
  std::string about;
  std::vector<SceneObject> objects;
  std::map<std::string, Camera> cameras;  // "default" is always there
  std::map<std::string, CameraPath> paths;
};

// What the file says, checked as far as that goes without loading: types, ranges of placements and cameras, and that
// every frame of a path has a view. Keys that are not known, given twice or missing are mistakes too. The name of the
// scene is that of the file without its extension. Throws Error that names the file and the JSON path of the mistake.
[[nodiscard]] SceneDescription read_scene(const std::filesystem::path& path);

// Whether the extension is .json, case ignored.
[[nodiscard]] bool is_scene_file(const std::filesystem::path& path);

// Of a scene file what read_scene() reads; of any other file, taken for a mesh or a hierarchy, a scene of that one
// object without cameras. Throws Error, for a folder too.
[[nodiscard]] SceneDescription describe_file(const std::filesystem::path& path);

// Writes what read_scene() reads: every placement as a matrix, every field of a camera, so that the same numbers come
// back. Throws Error for a scene without objects or without the camera "default", or when the file cannot be written.
void write_scene(const std::filesystem::path& path, const SceneDescription& scene);

// The camera of frame i of a path, 0 <= i < frames: eyes, targets, angles and ranges linear between keys that are
// spread evenly over the frames; up directions linear too, then of unit length. With `jump`, key floor(i * keys /
// frames) as it is. The size is the first key's.
[[nodiscard]] Camera camera_at(const CameraPath& path, int frame);

struct LoadOptions {
  BuildOptions build;
  // Keep hierarchies in ${XDG_CACHE_HOME:-~/.cache}/occlod under a hash of the input's bytes, the options and the
  // builder's sources.
  bool use_cache = true;
  // done in [0, 1]; what it throws ends the loading.
  std::function<void(const std::string& what, double done)> progress;
  std::function<void(const std::string& line)>
      note;  // told of a cache that cannot be used; the hierarchy is built all the same
};

struct LoadedObject {
  std::shared_ptr<const Hierarchy> hierarchy;  // shared by objects with the same source
  glm::dmat4 object_to_world{1.0};
  bool two_sided = false;
  std::string source_name;  // file or generator, for people
};

// Reads or generates the meshes and builds or fetches their hierarchies. `folder`: where relative names start, the
// scene file's own. Throws Error.
[[nodiscard]] std::vector<LoadedObject> load_objects(const SceneDescription& scene, const std::filesystem::path& folder,
                                                     const LoadOptions& options = {});

// Where a mesh of this name is found, or an empty path. Same search as for MeshFile; an absolute name is taken as it
// is.
[[nodiscard]] std::filesystem::path find_mesh(const std::string& name, const std::filesystem::path& folder);

}  // namespace occlod
