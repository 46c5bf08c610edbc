// Scenes: read, written, loaded.
#include "occlod/scene.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "arrays.h"
#include "bindings.h"
#include "device.h"
#include "text.h"

namespace occlod::python {
namespace {

using namespace nb::literals;

// As progress_of(), with what is being done.
std::function<void(const std::string&, double)> step_of(nb::handle progress) {
  return [progress](const std::string& what, double done) {
    const HeldGil gil;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (!progress.is_none()) progress(what, done);
  };
}

nb::handle or_none(const std::optional<nb::callable>& callable) {
  return callable ? nb::handle(*callable) : nb::handle(Py_None);
}

std::function<void(const std::string&)> note_of(const std::optional<nb::callable>& note) {
  if (!note) return {};
  return [told = or_none(note)](const std::string& line) {
    const HeldGil gil;
    told(line);
  };
}

std::vector<PlacedObject> load(const SceneDescription& scene, const std::filesystem::path& folder, int threads,
                               bool use_cache, const std::optional<nb::callable>& progress,
                               const std::optional<nb::callable>& note) {
  LoadOptions options;
  options.build.threads = threads;
  options.use_cache = use_cache;
  options.progress = step_of(or_none(progress));
  options.note = note_of(note);
  const ReleasedGil release;
  std::vector<PlacedObject> result;
  for (const LoadedObject& object : load_objects(scene, folder, options))
    result.push_back(
        {*object.hierarchy, object.object_to_world, object.two_sided, object.source_name, object.attributes});
  return result;
}

std::vector<HlodObject> load_hlods(const SceneDescription& scene, const std::filesystem::path& folder,
                                   LoadOptions options, const std::optional<nb::callable>& progress,
                                   const std::optional<nb::callable>& note) {
  options.progress = step_of(or_none(progress));
  options.note = note_of(note);
  const ReleasedGil release;
  std::vector<HlodObject> result;
  for (const LoadedHlod& object : occlod::load_hlods(scene, folder, options))
    result.push_back({*object.hlod, object.object_to_world, object.two_sided, object.source_name});
  return result;
}

std::filesystem::path folder_of(const SceneDescription& scene, const std::optional<std::filesystem::path>& folder) {
  return folder ? *folder : scene.file.parent_path();
}

void require_frame(const CameraPath& path, int frame) {
  if (frame < 0 || frame >= path.frames)
    throw nb::index_error(("the path has " + std::to_string(path.frames) + " frames").c_str());
  if (path.keys.empty()) throw nb::value_error("the path has no keys");
}

void bind_objects(nb::module_& m) {
  nb::class_<MeshFile>(m, "MeshFile", "A mesh or .olod file: the first of these names that is found.")
      .def(
          "__init__", [](MeshFile* self, std::vector<std::string> names) { new (self) MeshFile{std::move(names)}; },
          "names"_a)
      .def_rw("names", &MeshFile::names, "Relative to the scene's folder, or absolute. A copy: assign a list.");
  nb::class_<SceneObject>(m, "SceneObject", "One placed mesh of a scene.")
      .def(
          "__init__",
          [](SceneObject* self, MeshFile source, const std::optional<ArrayLike>& transform, bool two_sided,
             bool attributes) {
            const glm::dmat4 matrix = transform ? to_matrix(*transform, "transform") : glm::dmat4(1.0);
            new (self) SceneObject{std::move(source), matrix, two_sided, attributes};
          },
          "source"_a, "transform"_a = nb::none(), nb::kw_only(), "two_sided"_a = false, "attributes"_a = true)
      .def_prop_ro(
          "source",
          [](const SceneObject& o) -> std::optional<MeshFile> {
            if (const auto* const file = std::get_if<MeshFile>(&o.source)) return *file;
            return std::nullopt;
          },
          "The file; None for a generator.")
      .def_prop_rw(
          "transform", [](const SceneObject& o) { return from_matrix(o.object_to_world); },
          [](SceneObject& o, const ArrayLike& transform) { o.object_to_world = to_matrix(transform, "transform"); },
          nb::for_getter(nb::sig("def transform(self) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def transform(self, value: numpy.typing.ArrayLike, /) -> None")),
          "(4, 4) float64, the mesh's coordinates to world. A copy: assign a matrix.")
      .def_rw("two_sided", &SceneObject::two_sided, "Back faces are visible too.")
      .def_rw("attributes", &SceneObject::attributes, "How far attributes slip counts as an error too.");
  nb::class_<CameraPath>(m, "CameraPath", "A camera that moves between keys, or is held at each (`jump`).")
      .def(
          "__init__",
          [](CameraPath* self, std::vector<Camera> keys, int frames, bool jump) {
            new (self) CameraPath{std::move(keys), frames, jump};
          },
          "keys"_a, "frames"_a = 1, nb::kw_only(), "jump"_a = false)
      .def_rw("keys", &CameraPath::keys, "Copies: assign a list.")
      .def_rw("frames", &CameraPath::frames)
      .def_rw("jump", &CameraPath::jump)
      .def(
          "camera",
          [](const CameraPath& path, int frame) {
            require_frame(path, frame);
            return camera_at(path, frame);
          },
          "frame"_a, "The camera of a frame, 0 <= frame < frames.")
      .def("__len__", [](const CameraPath& path) { return path.frames; })
      .def("__getitem__", [](const CameraPath& path, int frame) {
        require_frame(path, frame);
        return camera_at(path, frame);
      });
}

}  // namespace

void bind_scene(nb::module_& m) {
  bind_objects(m);
  nb::class_<SceneDescription>(m, "Scene", "Objects, named cameras and camera paths, as a scene file says them.")
      .def(
          "__init__",
          [](SceneDescription* self, std::vector<SceneObject> objects, std::map<std::string, Camera> cameras,
             std::map<std::string, CameraPath> paths, std::string about) {
            new (self)
                SceneDescription{"", {}, std::move(about), std::move(objects), std::move(cameras), std::move(paths)};
          },
          "objects"_a, "cameras"_a, "paths"_a = std::map<std::string, CameraPath>(), nb::kw_only(), "about"_a = "",
          nb::sig("def __init__(self, objects: collections.abc.Sequence[SceneObject], "
                  "cameras: collections.abc.Mapping[str, Camera], "
                  "paths: collections.abc.Mapping[str, CameraPath] = ..., *, about: str = '') -> None"),
          "`cameras` has one that is called \"default\".")
      .def_static(
          "read",
          [](const std::filesystem::path& path) {
            const ReleasedGil release;
            return read_scene(path);
          },
          "path"_a, "A scene file. Error names the file and the JSON path of the mistake.")
      .def_static(
          "describe",
          [](const std::filesystem::path& path) {
            const ReleasedGil release;
            return describe_file(path);
          },
          "path"_a, "A scene file; or of a mesh or .olod file a scene of that one object without cameras.")
      .def(
          "write", [](const SceneDescription& scene, const std::filesystem::path& path) { write_scene(path, scene); },
          "path"_a, "From which read() reads the same numbers back.")
      .def_ro("name", &SceneDescription::name, "Of the file, without its extension.")
      .def_rw("about", &SceneDescription::about)
      .def_rw("objects", &SceneDescription::objects, "Copies: assign a list.")
      .def_rw("cameras", &SceneDescription::cameras, "Copies: assign a dict.")
      .def_rw("paths", &SceneDescription::paths, "Copies: assign a dict.")
      .def(
          "load",
          [](const SceneDescription& scene, const std::optional<std::filesystem::path>& folder, int threads,
             bool use_cache, const std::optional<nb::callable>& progress, const std::optional<nb::callable>& note) {
            return load(scene, folder_of(scene, folder), threads, use_cache, progress, note);
          },
          "folder"_a = nb::none(), nb::kw_only(), "threads"_a = 0, "use_cache"_a = true, "progress"_a = nb::none(),
          "note"_a = nb::none(),
          "Reads or generates the meshes and builds their hierarchies, or fetches them from the user's cache: one\n"
          "Object for each of the scene. Relative names start in `folder`, or beside the scene file. `progress` is\n"
          "called with what is being done and the share of it, `note` with one line when the cache cannot be used.")
      .def(
          "load_hlods",
          [](const SceneDescription& scene, const std::optional<std::filesystem::path>& folder,
             std::uint32_t node_triangles, hlod::Within within, int threads, bool use_cache,
             const std::optional<nb::callable>& progress, const std::optional<nb::callable>& note) {
            LoadOptions options;
            options.build_hlod.node_triangles = node_triangles;
            options.build_hlod.within = within;
            options.build_hlod.threads = threads;
            options.use_cache = use_cache;
            return load_hlods(scene, folder_of(scene, folder), options, progress, note);
          },
          "folder"_a = nb::none(), nb::kw_only(), "node_triangles"_a = hlod::HlodBuildOptions{}.node_triangles,
          "within"_a = hlod::HlodBuildOptions{}.within, "threads"_a = 0, "use_cache"_a = true,
          "progress"_a = nb::none(), "note"_a = nb::none(),
          "All objects that are no .ohlod files as one HLOD, built or fetched from the user's cache, then each .ohlod\n"
          "file at its place. Otherwise as load().")
      .def(
          "flatten",
          [](const SceneDescription& scene, const std::optional<std::filesystem::path>& folder,
             const std::optional<nb::callable>& progress) {
            const auto step = step_of(or_none(progress));
            const std::filesystem::path from = folder_of(scene, folder);
            const ReleasedGil release;
            CleanMesh result = flatten_scene(scene, from, step);
            return std::pair<TriangleMesh, MeshReport>(std::move(result.mesh), result.report);
          },
          "folder"_a = nb::none(), nb::kw_only(), "progress"_a = nb::none(),
          "All objects as one clean mesh in world space, and what was found in them.");
}

}  // namespace occlod::python
