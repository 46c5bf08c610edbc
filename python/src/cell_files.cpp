// View cells in files: building them, in parts on any number of machines, and reading them.
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <mutex>

#include "arrays.h"
#include "cell_cut.h"
#include "occlod/build_cells.h"
#include "refining.h"
#include "text.h"
#include "vlod.h"

namespace occlod::python {
namespace {

using namespace nb::literals;
namespace fs = std::filesystem;

// A range of root cells.
using Range = std::pair<std::uint32_t, std::uint32_t>;
CellRange range_of(const Range& range) { return {range.first, range.second}; }

struct PythonCellBuild {
  PythonCellBuild(std::vector<PlacedObject> placed, const CellTreeOptions& options)
      : objects(std::move(placed)), build(objects.refine_objects(), options) {}

  KeptObjects objects;
  CellBuild build;
  std::mutex in_use;
};

std::function<bool(double)> or_nothing(const std::optional<nb::callable>& progress) {
  return progress_of(progress ? nb::handle(*progress) : nb::handle(Py_None));
}

// Throws IndexError.
const CellNode& node_of(const PythonVlodFile& self, CellId cell) {
  const CellTree& tree = self.file->tree();
  if (cell >= tree.nodes().size())
    throw nb::index_error(("there are " + std::to_string(tree.nodes().size()) + " nodes").c_str());
  return tree.node(cell);
}

std::optional<CellId> or_none(CellId cell) { return cell == no_id ? std::nullopt : std::optional(cell); }

std::unique_ptr<PythonCellCut> cut_of(const PythonVlodFile& self, CellId leaf) {
  const CellNode& node = node_of(self, leaf);
  if (!self.file->tree().is_leaf(leaf)) throw nb::index_error("no leaf: it has cells below it");
  if (!self.objects) throw nb::value_error("it was opened without objects");
  const ReleasedGil release;
  CellCut cut;
  cut.objects = read_cell(*self.file, self.objects->refine_objects(), leaf);
  cut.triangles = node.triangles;
  cut.drawn_triangles = node.drawn_triangles;
  cut.error_px = node.error_px;
  return std::make_unique<PythonCellCut>(PythonCellCut{std::move(cut), self.objects});
}

// What __setstate__() of CellTreeOptions takes.
using TreeState = std::tuple<CellOptions, std::vector<CellBox>, std::tuple<double, double>, std::uint64_t, CellDivision,
                             std::optional<double>>;

void bind_tree_options(nb::module_& m) {
  nb::enum_<CellDivision>(m, "CellDivision", "When a cell is divided that draws more than CellTreeOptions says.")
      .value("halving", CellDivision::halving, "If a part draws less than half of what it draws (vLOD, 2003).")
      .value("gain", CellDivision::gain, "If its parts draw, on average by volume, less than nine tenths of that.");
  const CellTreeOptions standard;
  nb::class_<CellTreeOptions>(m, "CellTreeOptions", "All that decides what is in a .vlod file, besides the objects.")
      .def(
          "__init__",
          [](CellTreeOptions* self, std::vector<CellBox> regions, const CellOptions& cell, double root_cell,
             double smallest_cell, std::uint64_t max_triangles, CellDivision division,
             std::optional<double> occluder_motion) {
            new (self) CellTreeOptions{cell,          std::move(regions), root_cell,      smallest_cell,
                                       max_triangles, division,           occluder_motion};
          },
          "regions"_a, nb::kw_only(), "cell"_a = standard.cell, "root_cell"_a = standard.root_cell,
          "smallest_cell"_a = standard.smallest_cell, "max_triangles"_a = standard.max_triangles,
          "division"_a = standard.division, "occluder_motion"_a = nb::none())
      .def_rw("regions", &CellTreeOptions::regions, "Where the eye may be, world space. Copies: assign a list.")
      .def_rw("cell", &CellTreeOptions::cell, "Of each cell.")
      .def_rw("root_cell", &CellTreeOptions::root_cell, "No edge of an undivided cell is longer; world units.")
      .def_rw("smallest_cell", &CellTreeOptions::smallest_cell, "No edge is divided that would become shorter.")
      .def_rw("max_triangles", &CellTreeOptions::max_triangles, "A cell that draws more may be divided.")
      .def_rw("division", &CellTreeOptions::division, "Whether that is worth while.")
      .def_rw("occluder_motion", &CellTreeOptions::occluder_motion,
              "How far occluders may have moved, world units; None: a quarter of smallest_cell.")
      .def("__getstate__",
           [](const CellTreeOptions& o) {
             return TreeState{o.cell,          o.regions,  {o.root_cell, o.smallest_cell},
                              o.max_triangles, o.division, o.occluder_motion};
           })
      .def("__setstate__", [](CellTreeOptions& self, TreeState state) {
        auto& [cell, regions, edges, max_triangles, division, motion] = state;
        new (&self) CellTreeOptions{
            cell, std::move(regions), std::get<0>(edges), std::get<1>(edges), max_triangles, division, motion};
      });
}

void bind_build(nb::module_& m) {
  nb::class_<PythonCellBuild>(
      m, "CellBuild",
      "Builds the .vlod file of one scene and one set of options: in one piece, or in parts on\n"
      "any number of machines, which merge_cells() joins. The same objects and options give\n"
      "the same bytes. Calls from several threads wait for each other.")
      .def(
          "__init__",
          [](PythonCellBuild* self, nb::object objects, const CellTreeOptions& options) {
            std::vector<PlacedObject> placed = to_objects(objects);
            const ReleasedGil release;
            new (self) PythonCellBuild(std::move(placed), options);
          },
          "objects"_a, "options"_a,
          nb::sig("def __init__(self, objects: Object | Hierarchy | collections.abc.Iterable[Object | Hierarchy], "
                  "options: CellTreeOptions) -> None"),
          "Error for options out of their range.")
      .def_prop_ro(
          "root_cells", [](const PythonCellBuild& self) { return self.build.root_cell_count(); },
          "How many undivided cells there are: in their order, along a Hilbert curve within each region.")
      .def(
          "shard",
          [](const PythonCellBuild& self, std::uint32_t i, std::uint32_t n) {
            if (i >= n) throw nb::index_error("i is not below n");
            const CellRange range = self.build.shard(i, n);
            return Range{range.first, range.count};
          },
          "i"_a, "n"_a, "The i-th of n runs of root cells: its first, and how many; 0 where there are fewer of them.")
      .def(
          "part_name",
          [](const PythonCellBuild& self, const Range& range) { return self.build.part_name(range_of(range)); },
          "range"_a, "Of the .vpart file of this run: another for another scene or other options.")
      .def(
          "has_part",
          [](const PythonCellBuild& self, const fs::path& part, const Range& range) {
            const ReleasedGil release;
            return self.build.has_part(part, range_of(range));
          },
          "part"_a, "range"_a, "Whether the file is there, whole, and what write_part() would write. O(bytes).")
      .def(
          "write_part",
          [](PythonCellBuild& self, const fs::path& part, const Range& range, int threads,
             const std::optional<nb::callable>& progress) {
            const auto show = or_nothing(progress);
            const ReleasedGil release;
            const std::scoped_lock lock(self.in_use);
            self.build.write_part(part, range_of(range), threads, show);
          },
          "part"_a, "range"_a, nb::kw_only(), "threads"_a = 0, "progress"_a = nb::none(),
          "Divides these root cells and writes them; the file appears whole or not at all. `threads` 0: one for each\n"
          "core. `progress` is called with the share that is done.")
      .def(
          "write",
          [](PythonCellBuild& self, const fs::path& path, int threads, const std::optional<nb::callable>& progress) {
            const auto show = or_nothing(progress);
            const ReleasedGil release;
            const std::scoped_lock lock(self.in_use);
            self.build.write(path, threads, show);
          },
          "path"_a, nb::kw_only(), "threads"_a = 0, "progress"_a = nb::none(),
          "The same for all root cells, as a .vlod file.")
      .def_prop_ro(
          "cuts", [](const PythonCellBuild& self) { return self.build.cuts(); }, "That were found so far.");
  m.def(
      "merge_cells",
      [](const std::vector<fs::path>& parts, const fs::path& path) {
        const ReleasedGil release;
        merge_cells(parts, path);
      },
      "parts"_a, "path"_a,
      "Writes the .vlod file of parts that together have every root cell. Error for one that is damaged, for parts of\n"
      "other scenes or options, and for root cells that are missing.");
}

void bind_file(nb::module_& m) {
  nb::class_<CellNode>(m, "CellNode", "A box of space in a .vlod file; those without others below are the view cells.")
      .def_ro("box", &CellNode::box)
      .def_ro("level", &CellNode::level, "Nodes above it.")
      .def_ro("splits", &CellNode::splits, "That it adds to those above it.")
      .def_ro("triangles", &CellNode::triangles, "Of a leaf: of its cut.")
      .def_ro("drawn_triangles", &CellNode::drawn_triangles, "Of a leaf: of these, to draw.")
      .def_ro("error_px", &CellNode::error_px, "Of a leaf: how far anything seen is from what is drawn, at most.");
  nb::class_<PythonVlodFile>(m, "VlodFile", "View cells in a file. Immutable; threads may share it.")
      .def(
          "__init__",
          [](PythonVlodFile* self, const fs::path& path, const std::optional<nb::object>& objects) {
            new (self) PythonVlodFile(open_file(path, objects ? nb::handle(*objects) : nb::handle(Py_None)));
          },
          "path"_a, "objects"_a = nb::none(),
          nb::sig("def __init__(self, path: str | os.PathLike[str], objects: Object | Hierarchy | "
                  "collections.abc.Iterable[Object | Hierarchy] | None = None) -> None"),
          "Error for a file that is damaged, and for objects other than those that the cells were built for; without\n"
          "objects its cells can be looked at, and walked through if it is packed.")
      .def(
          "__len__", [](const PythonVlodFile& f) { return f.file->tree().nodes().size(); }, "Number of nodes.")
      .def_prop_ro(
          "leaves", [](const PythonVlodFile& f) { return f.file->tree().leaf_count(); }, "Number of view cells.")
      .def_prop_ro(
          "options", [](const PythonVlodFile& f) { return f.file->options(); }, "That it was built with.")
      .def_prop_ro(
          "file_bytes", [](const PythonVlodFile& f) { return f.file->file_bytes(); }, "Its size.")
      .def_prop_ro(
          "is_packed", [](const PythonVlodFile& f) { return f.file->is_packed(); },
          "Whether it holds the geometry of its cells.")
      .def(
          "pack",
          [](const PythonVlodFile& f, const fs::path& path, const std::optional<nb::callable>& progress) {
            if (!f.objects) throw nb::value_error("it was opened without objects");
            const auto show = or_nothing(progress);
            const ReleasedGil release;
            pack_cells(*f.file, f.objects->refine_objects(), path, show);
          },
          "path"_a, nb::kw_only(), "progress"_a = nb::none(),
          "Writes the same cells with their geometry, so that no hierarchies are needed to walk through the file.\n"
          "ValueError without objects.")
      .def("node", &node_of, "cell"_a, nb::rv_policy::copy, "IndexError for one that is not there.")
      .def(
          "leaf_of", [](const PythonVlodFile& f, glm::dvec3 eye) { return or_none(f.file->tree().leaf_of(eye)); },
          "eye"_a, "The view cell that holds the eye; None outside all.")
      .def(
          "neighbours",
          [](const PythonVlodFile& f, CellId leaf) {
            static_cast<void>(node_of(f, leaf));  // throws
            std::vector<CellId> cells;
            f.file->tree().neighbours(leaf, cells);
            return cells;
          },
          "leaf"_a, "View cells that share a piece of a face with this one.")
      .def(
          "cut", &cut_of, "leaf"_a,
          "What to draw in a view cell, as CellBuilder.build() gave it, without its counts. Reads its path. Error for\n"
          "a file that is damaged there, IndexError for what is no leaf, ValueError without objects.");
}

}  // namespace

PythonVlodFile open_file(const fs::path& path, nb::handle objects) {
  std::shared_ptr<const KeptObjects> kept;
  if (!objects.is_none()) kept = std::make_shared<KeptObjects>(to_objects(objects));
  const ReleasedGil release;
  return {kept ? open_vlod(path, kept->refine_objects()) : open_vlod(path), kept};
}

void bind_cell_files(nb::module_& m) {
  bind_tree_options(m);
  bind_build(m);
  bind_file(m);
}

}  // namespace occlod::python
