// What to draw of HLODs in a view, for renderers of Python's own.
#include "occlod/select.h"

#include <nanobind/stl/unique_ptr.h>

#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "device.h"
#include "node_mesh.h"
#include "text.h"
#include "view_like.h"

namespace occlod::python {
namespace {

using namespace nb::literals;
using hlod::Hlod;
using hlod::SelectOptions;

struct PythonSelector {
  explicit PythonSelector(std::vector<HlodObject> objects)
      : hlods(std::make_shared<KeptHlods>(std::move(objects))), selector(hlods->placed) {}
  std::shared_ptr<KeptHlods> hlods;
  hlod::Selector selector;
  std::mutex in_use;
};

// A selection of its own: without meshes, which are found by node.
struct PythonSelection {
  PythonSelection(const hlod::Selection& selected, std::shared_ptr<const KeptHlods> of)
      : hlods(std::move(of)), counts(selected) {
    for (const hlod::SelectedNode& node : selected.nodes) {
      draws.push_back({node.object, node.node, static_cast<std::uint32_t>(ranges.size()),
                       static_cast<std::uint32_t>(node.ranges.size())});
      ranges.insert(ranges.end(), node.ranges.begin(), node.ranges.end());
    }
    counts.nodes.clear();
  }

  std::shared_ptr<const KeptHlods> hlods;
  hlod::Selection counts;
  std::vector<std::array<std::uint32_t, 4>> draws;  // object, node, first range, number of ranges
  std::vector<hlod::DrawRange> ranges;
};

std::unique_ptr<PythonSelection> select(PythonSelector& self, const ViewLike& view, double tolerance_px,
                                        std::size_t budget, bool occlusion, bool geomorph) {
  const View seen = view.get();
  const SelectOptions options{tolerance_px, budget, occlusion, geomorph};
  std::optional<ReleasedGil> release;
  if (!self.hlods->are_paged()) release.emplace();
  const std::scoped_lock lock(self.in_use);
  return std::make_unique<PythonSelection>(self.selector.select(seen, options), self.hlods);
}

TriangleMesh mesh_of(const PythonSelection& selection, std::size_t object) {
  const std::vector<HlodObject>& objects = selection.hlods->objects;
  if (object >= objects.size())
    throw nb::index_error(("there are " + std::to_string(objects.size()) + " objects").c_str());
  const Hlod& hlod = objects[object].hlod;
  TriangleMesh mesh = mesh_like(hlod.data());
  std::vector<std::uint16_t> indices;
  for (const auto& [of, node, first, count] : selection.draws) {
    if (of != object) continue;
    hlod.require(node);
    const hlod::NodeMesh part = hlod.mesh(node);
    indices.clear();
    for (const hlod::DrawRange& range : std::span(selection.ranges).subspan(first, count)) {
      const auto of_range = part.indices.subspan(range.first_index, range.index_count);
      indices.insert(indices.end(), of_range.begin(), of_range.end());
    }
    append_triangles(mesh, part, indices);
  }
  return mesh;
}

void bind_selection(nb::module_& m) {
  nb::class_<PythonSelection>(m, "Selection",
                              "What to draw in a view. Its arrays are read-only views, which keep it alive.")
      .def_prop_ro(
          "draws",
          [](nb::handle self) {
            const auto& draws = nb::cast<const PythonSelection&>(self).draws;
            return rows_view<const std::uint32_t, 4>(draws.empty() ? nullptr : draws[0].data(), draws.size(), self);
          },
          "(d, 4) uint32, about from front to back: object, node, first range, number of ranges. A node with several\n"
          "parents may come twice, with other ranges.")
      .def_prop_ro(
          "ranges",
          [](nb::handle self) {
            const auto& ranges = nb::cast<const PythonSelection&>(self).ranges;
            static_assert(offsetof(hlod::DrawRange, index_count) == 4 && sizeof(hlod::DrawRange) == 12);
            return rows_view<const std::uint32_t, 2>(ranges.empty() ? nullptr : &ranges[0].first_index, ranges.size(),
                                                     self, 3);
          },
          "(r, 2) uint32: first index and number of indices, in the triangles of the node's mesh as one list.")
      .def_prop_ro(
          "morphs",
          [](nb::handle self) {
            const auto& ranges = nb::cast<const PythonSelection&>(self).ranges;
            return values_view<const float>(ranges.empty() ? nullptr : &ranges[0].morph, ranges.size(), self, 3);
          },
          "(r,) float32: how far vertices have gone to where merged_into says, 0 to 1.")
      .def_prop_ro(
          "triangles", [](const PythonSelection& s) { return s.counts.triangles; }, "How many.")
      .def_prop_ro(
          "tolerance_px", [](const PythonSelection& s) { return s.counts.tolerance_px; },
          "That nodes were selected by: as given, or what the budget needs.")
      .def_prop_ro(
          "largest_error_px", [](const PythonSelection& s) { return s.counts.largest_error_px; },
          "Of a node; larger than the tolerance only where meshes are missing or the budget is too small.")
      .def_prop_ro(
          "hidden", [](const PythonSelection& s) { return s.counts.hidden; },
          "Nodes that were left out, with all that is below them.")
      .def_prop_ro(
          "missing", [](const PythonSelection& s) { return s.counts.missing; },
          "Meshes that were not there, so that coarser ones are selected: Hlod.missing().")
      .def("mesh", &mesh_of, "object"_a = 0,
           "A Mesh of its own of what is selected of an object, in object space, with normals, colours, texture\n"
           "coordinates and materials; nodes have vertices of their own, which clean() joins. Call it before the next\n"
           "select() where meshes come and go. O(n).");
}

}  // namespace

void bind_select(nb::module_& m) {
  bind_selection(m);
  const SelectOptions standard;
  nb::class_<PythonSelector>(
      m, "Selector",
      "Says what to draw of HLODs, frame by frame: within a tolerance or a budget, without what\n"
      "is hidden. Calls from several threads wait for each other.")
      .def(
          "__init__", [](PythonSelector* self, nb::object objects) { new (self) PythonSelector(to_hlods(objects)); },
          "objects"_a,
          nb::sig(
              "def __init__(self, objects: HlodObject | Hlod | collections.abc.Iterable[HlodObject | Hlod]) -> None"))
      .def("select", &select, "view"_a, nb::kw_only(), "tolerance_px"_a = standard.tolerance_px,
           "budget"_a = standard.budget, "occlusion"_a = standard.occlusion, "geomorph"_a = standard.geomorph,
           "Everything visible is off by at most `tolerance_px` pixels (0: the input), which grows until no more than\n"
           "`budget` triangles are selected (0: no limit). `occlusion` leaves out what is hidden in a depth image of "
           "the\n"
           "view's size. `geomorph` fills Selection.morphs. Error for a tolerance below 0.")
      .def(
          "set_transform",
          [](PythonSelector& s, std::size_t object, const ArrayLike& transform) {
            const glm::dmat4 matrix = to_matrix(transform, "transform");
            const ReleasedGil release;
            const std::scoped_lock lock(s.in_use);
            s.selector.set_transform(object, matrix);
          },
          "object"_a, "transform"_a, "Moves an object; what is known of its visibility is kept.");
}

}  // namespace occlod::python
