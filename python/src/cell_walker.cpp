// Walking through files of view cells, frame by frame.
#include "occlod/cell_walker.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>
#include <variant>

#include "arrays.h"
#include "materials.h"
#include "text.h"
#include "view_like.h"
#include "vlod.h"

namespace occlod::python {
namespace {

using namespace nb::literals;
namespace fs = std::filesystem;

// A walker with what it needs. Calls come one at a time.
struct PythonCellWalker {
  PythonCellWalker(PythonVlodFile opened, const WalkOptions& options)
      : file(std::move(opened)),
        objects(file.objects ? file.objects->refine_objects() : placements(*file.file)),
        walker(file.file, file.objects ? std::span<const RefineObject>(objects) : std::span<const RefineObject>(),
               options),
        loader(walker) {}

  PythonVlodFile file;
  std::vector<RefineObject> objects;
  CellWalker walker;
  CellLoader loader;
  std::mutex in_use;
};

// What one step gave, for as long as Python holds it.
struct PythonWalkedFrame {
  WalkedFrame frame;
  PythonVlodFile file;
  std::vector<RefineObject> objects;

  // Throws IndexError.
  [[nodiscard]] const WalkedObject& object(std::size_t i) const {
    if (i >= frame.objects.size())
      throw nb::index_error(("there are " + std::to_string(frame.objects.size()) + " objects").c_str());
    return frame.objects[i];
  }
};

const PythonWalkedFrame& frame_in(nb::handle self) { return nb::cast<const PythonWalkedFrame&>(self); }

std::unique_ptr<PythonWalkedFrame> step(PythonCellWalker& self, const glm::dvec3& eye, double seconds) {
  if (!std::isfinite(eye.x) || !std::isfinite(eye.y) || !std::isfinite(eye.z))
    throw nb::value_error("eye: is not finite");
  if (!(seconds >= 0.0) || !std::isfinite(seconds)) throw nb::value_error("seconds: is not a finite number >= 0");
  const ReleasedGil release;
  const std::scoped_lock lock(self.in_use);
  auto result = std::make_unique<PythonWalkedFrame>();
  result->frame = self.walker.step(eye, seconds);
  result->file = self.file;
  result->objects = self.objects;
  return result;
}

std::size_t load(PythonCellWalker& self, std::size_t most) {
  const ReleasedGil release;
  const std::scoped_lock lock(self.in_use);
  std::size_t loads = 0;
  for (; loads < most && self.loader.begin(); ++loads) self.loader.finish();
  return loads;
}

Array2<std::uint32_t, 3> ranges_in(const PythonWalkedFrame& self, const ViewLike& view) {
  std::vector<ObjectRange> ranges;
  ranges_in_view(self.frame, self.objects, view.get(), ranges);
  std::vector<std::uint32_t> values;
  for (const ObjectRange& range : ranges) values.insert(values.end(), {range.object, range.first, range.count});
  return rows_array_of<std::uint32_t, 3>(std::move(values));
}

std::vector<PythonDrawObject> draw_objects_of(nb::handle self) {
  const PythonWalkedFrame& walked = frame_in(self);
  std::vector<PythonDrawObject> objects;
  for (std::size_t i = 0; i < walked.frame.objects.size(); ++i) {
    const WalkedObject& object = walked.frame.objects[i];
    objects.push_back(
        {{object.positions, object.colors, object.triangles, walked.objects[i].object_to_world}, {nb::borrow(self)}});
  }
  return objects;
}

void bind_frame(nb::module_& m) {
  nb::class_<PythonWalkedFrame> frame(
      m, "WalkedFrame",
      "What to draw in one frame. Its arrays are read-only views, which keep it alive;\n"
      "later steps do not change it.");
  const auto add = [&](const char* name, auto WalkedFrame::*member, const char* what) {
    frame.def_prop_ro(
        name, [member](const PythonWalkedFrame& f) { return f.frame.*member; }, what);
  };
  add("cell", &WalkedFrame::cell, "The leaf where the eye is, or that nearest to it.");
  add("shown", &WalkedFrame::shown, "Whose cut is drawn: `cell`, or a node above it.");
  add("outside", &WalkedFrame::outside, "The eye is in no leaf: nothing is promised.");
  add("crossed", &WalkedFrame::crossed, "`cell` is another than in the frame before.");
  add("changed", &WalkedFrame::changed, "What is drawn is another than in the frame before: to be uploaded.");
  add("late", &WalkedFrame::late, "`shown` is not `cell`: its cut is not there yet.");
  add("missing", &WalkedFrame::missing, "Late, and it will not come.");
  add("error_px", &WalkedFrame::error_px, "How far anything seen is from what is drawn, at most.");
  add("drawn_triangles", &WalkedFrame::drawn_triangles, "Of all objects.");
  add("bytes_read", &WalkedFrame::bytes_read, "Of the file, by loads that have ended since the step before.");
  add("loads", &WalkedFrame::loads, "That have ended since the step before.");
  add("resident_bytes", &WalkedFrame::resident_bytes, "Of what the walker's `memory` limits.");
  frame
      .def_prop_ro(
          "notes", [](const PythonWalkedFrame& f) { return f.frame.notes; },
          "What could not be loaded, as this step found out: lines of text.")
      .def(
          "__len__", [](const PythonWalkedFrame& f) { return f.frame.objects.size(); }, "Number of objects.")
      .def(
          "triangles", [](nb::handle self, std::size_t i) { return view_of(frame_in(self).object(i).triangles, self); },
          "object"_a = 0, "(m, 3) uint32, to draw: ids into positions(object).")
      .def(
          "positions", [](nb::handle self, std::size_t i) { return view_of(frame_in(self).object(i).positions, self); },
          "object"_a = 0, "(n, 3) float32, object space: of the hierarchy, or of a packed file those of the cell.")
      .def(
          "normals", [](nb::handle self, std::size_t i) { return view_of(frame_in(self).object(i).normals, self); },
          "object"_a = 0, "(n, 3) float32, or (0, 3) where vertices have none.")
      .def(
          "colors", [](nb::handle self, std::size_t i) { return view_of(frame_in(self).object(i).colors, self); },
          "object"_a = 0, "(n, 4) uint8, or (0, 4) where vertices have none.")
      .def(
          "texture_coordinates",
          [](nb::handle self, std::size_t i) { return view_of(frame_in(self).object(i).texture_coordinates, self); },
          "object"_a = 0, "(n, 2) float32 as the input has them, or (0, 2) where vertices have none.")
      .def(
          "wedge_materials",
          [](nb::handle self, std::size_t i) { return view_of(frame_in(self).object(i).wedge_materials, self); },
          "object"_a = 0,
          "(n,) uint16: the material of the triangles at each of the positions; (0,) when there is one or none.")
      .def(
          "materials",
          [](const PythonWalkedFrame& f, std::size_t i) { return tuple_of<Material>(f.object(i).surface.materials); },
          "object"_a = 0, nb::sig("def materials(self, object: int = 0) -> tuple[Material, ...]"),
          "That wedge_materials(object) counts. Copies.")
      .def(
          "textures",
          [](const PythonWalkedFrame& f, std::size_t i) { return tuple_of<Texture>(f.object(i).surface.textures); },
          "object"_a = 0, nb::sig("def textures(self, object: int = 0) -> tuple[Texture, ...]"),
          "That materials(object) count. Copies, with the images that the mesh file held.")
      .def(
          "texture_origin",
          [](const PythonWalkedFrame& f, std::size_t i) { return f.object(i).surface.texture_origin; }, "object"_a = 0,
          "Of texture_coordinates(object).")
      .def(
          "transform",
          [](const PythonWalkedFrame& f, std::size_t i) {
            static_cast<void>(f.object(i));  // throws
            return from_matrix(f.objects[i].object_to_world);
          },
          "object"_a = 0, nb::sig("def transform(self, object: int = 0) -> numpy.typing.NDArray[numpy.float64]"),
          "(4, 4), from object space to the world.")
      .def("ranges_in_view", &ranges_in, "view"_a,
           "(r, 3) uint32: object, first triangle and number of triangles of those that may be in the frustum.")
      .def("draw_objects", &draw_objects_of, "For draw_items(), shade() and picture().");
}

}  // namespace

void bind_cell_walker(nb::module_& m) {
  bind_frame(m);
  const WalkOptions standard;
  nb::class_<PythonCellWalker>(
      m, "CellWalker",
      "Chooses what to draw in each frame of a walk through view cells; loads ahead in threads\n"
      "of its own. Calls from several threads wait for each other.")
      .def(
          "__init__",
          [](PythonCellWalker* self, const std::variant<PythonVlodFile*, fs::path>& file, nb::handle objects,
             std::size_t memory, int loaders) {
            if (std::holds_alternative<PythonVlodFile*>(file) && !objects.is_none())
              throw nb::type_error("objects: the VlodFile has been opened with or without them; leave them out");
            WalkOptions options;
            options.memory = memory;
            options.loaders = loaders;
            PythonVlodFile opened = std::holds_alternative<PythonVlodFile*>(file)
                                        ? *std::get<PythonVlodFile*>(file)
                                        : open_file(std::get<fs::path>(file), objects);
            const ReleasedGil release;
            new (self) PythonCellWalker(std::move(opened), options);
          },
          "file"_a, "objects"_a = nb::none(), nb::kw_only(), "memory"_a = standard.memory,
          "loaders"_a = standard.loaders,
          nb::sig("def __init__(self, file: VlodFile | str | os.PathLike[str], objects: Object | Hierarchy | "
                  "collections.abc.Iterable[Object | Hierarchy] | None = None, *, memory: int = ..., "
                  "loaders: int = 1) -> None"),
          "`file`: one that was opened with its objects; or packed and without. Or a path, which is opened with\n"
          "`objects`. `memory`: bytes that may be in memory of cells. `loaders`: threads that load; with 0 load() has\n"
          "to. Error for options out of their range, and for files that are damaged.")
      .def("step", &step, "eye"_a, "seconds"_a,
           "Goes on to this eye (world space), so many seconds after the step before. Never waits for the disk.")
      .def("load", &load, "most"_a = std::numeric_limits<std::size_t>::max(),
           "Loads what is wanted now, the most urgent first, in this thread: so many cells at most. Returns how many.\n"
           "With `loaders` 0 a walk does not depend on time.");
}

}  // namespace occlod::python
