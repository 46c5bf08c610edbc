// HLODs at their places, and what is drawn of them.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>

#include "arrays.h"
#include "bindings.h"
#include "device.h"
#include "occlod/traverser.h"
#include "text.h"
#include "view_like.h"

namespace occlod::python {
namespace {

using namespace nb::literals;
using hlod::FrameStats;
using hlod::FrameTimes;
using hlod::Hlod;
using hlod::TraverseOptions;

struct PythonTraverser {
  explicit PythonTraverser(std::vector<HlodObject> objects)
      : hlods(std::make_shared<KeptHlods>(std::move(objects))), traverser(hlods->placed) {}
  std::shared_ptr<KeptHlods> hlods;
  hlod::Traverser traverser;
  std::mutex in_use;
};

// A frame, and the cuts of its nodes, which the traverser keeps only until the next.
struct PythonFrame {
  explicit PythonFrame(const hlod::Frame& drawn) : frame(drawn) {
    std::size_t size = 0;
    for (const hlod::DrawnNode& draw : frame.draws) size += draw.cut.size();
    cuts.reserve(size);
    for (hlod::DrawnNode& draw : frame.draws) {
      const std::size_t first = cuts.size();
      cuts.insert(cuts.end(), draw.cut.begin(), draw.cut.end());
      draw.cut = {cuts.data() + first, draw.cut.size()};
    }
  }
  PythonFrame(const PythonFrame&) = delete;
  PythonFrame& operator=(const PythonFrame&) = delete;

  // Throws IndexError.
  [[nodiscard]] const hlod::DrawnNode& draw(std::size_t i) const {
    if (i >= frame.draws.size())
      throw nb::index_error(("there are " + std::to_string(frame.draws.size()) + " draws").c_str());
    return frame.draws[i];
  }

  hlod::Frame frame;
  std::vector<std::uint16_t> cuts;
};

std::unique_ptr<PythonFrame> draw_frame(PythonTraverser& self, const ViewLike& view, PythonDevice& device,
                                        const std::optional<TraverseOptions>& options) {
  const View seen = view.get();
  TraverseOptions chosen = options.value_or(TraverseOptions{});
  std::optional<ReleasedGil> release;
  if (!self.hlods->are_paged()) release.emplace();
  const std::scoped_lock lock(self.in_use, device.in_use);
  if (hlod::needs_costs(chosen.strategy)) chosen.costs = device.needed_costs();
  device.drawn = self.hlods;
  return std::make_unique<PythonFrame>(self.traverser.draw_frame(seen, *device.device, chosen));
}

void bind_traverse_enums(nb::module_& m) {
  using hlod::Strategy;
  nb::enum_<Strategy>(m, "Strategy", "Which nodes are drawn, and which queries decide it.")
      .value("vfc", Strategy::vfc, "All inside the frustum; no queries.")
      .value("coh", Strategy::coh, "Charalambos and others 2007: predicted from the last frame.")
      .value("nohc", Strategy::nohc, "Guthe and others 2006: asks where cost and benefit say so.")
      .value("batch", Strategy::batch, "Ours: predicted as by coh, asked together.")
      .value("automatic", Strategy::automatic, "Ours: batch or vfc, whichever is found to take less.");
}

void bind_traverse_options(nb::module_& m) {
  const TraverseOptions standard;
  nb::class_<TraverseOptions>(m, "TraverseOptions", "How a frame of HLODs is traversed.")
      .def(
          "__init__",
          [](TraverseOptions* self, hlod::Strategy strategy, double tolerance_px, double bias_s, double bias_t,
             bool geomorph, bool within) {
            TraverseOptions made;
            made.strategy = strategy;
            made.tolerance_px = tolerance_px;
            made.bias = {bias_s, bias_t};
            made.geomorph = geomorph;
            made.within = within;
            new (self) TraverseOptions(made);
          },
          nb::kw_only(), "strategy"_a = standard.strategy, "tolerance_px"_a = standard.tolerance_px,
          "bias_s"_a = standard.bias.s, "bias_t"_a = standard.bias.t, "geomorph"_a = standard.geomorph,
          "within"_a = standard.within)
      .def_rw("strategy", &TraverseOptions::strategy, "A change forgets what was visible.")
      .def_rw("tolerance_px", &TraverseOptions::tolerance_px, ">= 0; 0: the input itself.")
      .def_prop_rw(
          "bias_s", [](const TraverseOptions& o) { return o.bias.s; },
          [](TraverseOptions& o, double s) { o.bias.s = s; }, "Share of the sigmoid in the bias, in [0, 1].")
      .def_prop_rw(
          "bias_t", [](const TraverseOptions& o) { return o.bias.t; },
          [](TraverseOptions& o, double t) { o.bias.t = t; }, "Its turning point, in [0, 1].")
      .def_rw("geomorph", &TraverseOptions::geomorph,
              "Vertices slide to the parent's while its error goes from twice tolerance_px to tolerance_px.")
      .def_rw("within", &TraverseOptions::within,
              "Of HLODs with Within.splits: nodes are refined within, by collapses of their own. Not with geomorph.");
}

void bind_traverse_frame(nb::module_& m) {
  nb::class_<FrameStats>(m, "FrameStats", "Counts of one frame of HLODs.")
      .def_ro("visits", &FrameStats::visits, "Nodes taken from the queue and inside the frustum.")
      .def_ro("drawn_nodes", &FrameStats::drawn_nodes, "Drawn at least in part.")
      .def_ro("drawn_patches", &FrameStats::drawn_patches)
      .def_ro("drawn_triangles", &FrameStats::drawn_triangles)
      .def_ro("cut_nodes", &FrameStats::cut_nodes, "Of drawn_nodes, those refined within.")
      .def_ro("rarn", &FrameStats::rarn, "Of drawn_nodes, those that were refined in the same frame too.")
      .def_ro("delayed", &FrameStats::delayed, "Of drawn_nodes, those that were drawn only when their answer came.")
      .def_ro("blocked", &FrameStats::blocked, "Drawn since one of their parents was not refined.")
      .def_ro("queries", &FrameStats::queries, "Boxes asked about.")
      .def_ro("wasted_queries", &FrameStats::wasted_queries, "Answered visible, and nothing was decided by it.")
      .def_ro("hidden_nodes", &FrameStats::hidden_nodes)
      .def_ro("largest_sse_px", &FrameStats::largest_sse_px, "The largest screen-space error drawn, without bias.");
  nb::class_<FrameTimes>(m, "FrameTimes", "What one frame took on the device, ms.")
      .def_ro("frame_ms", &FrameTimes::frame_ms)
      .def_ro("cpu_ms", &FrameTimes::cpu_ms, "Of the calling thread, waiting included.")
      .def_ro("gpu_ms", &FrameTimes::gpu_ms, "That the device was busy.")
      .def_ro("stall_ms", &FrameTimes::stall_ms, "That the calling thread waited for answers.")
      .def_ro("starve_ms", &FrameTimes::starve_ms, "That the device had nothing to do.");
  nb::class_<PythonFrame>(m, "HlodFrame", "One frame. Its arrays are read-only views, which keep it alive.")
      .def_prop_ro(
          "draws",
          [](nb::handle self) {
            const auto& draws = nb::cast<const PythonFrame&>(self).frame.draws;
            using hlod::DrawnNode;
            static_assert(offsetof(DrawnNode, node) == 4 && offsetof(DrawnNode, first_range) == 8 &&
                          offsetof(DrawnNode, range_count) == 12 && sizeof(DrawnNode) % 4 == 0);
            return rows_view<const std::uint32_t, 4>(draws.empty() ? nullptr : &draws[0].object, draws.size(), self,
                                                     sizeof(DrawnNode) / 4);
          },
          "(d, 4) uint32, in the order of drawing: object, node, first range, number of ranges, 0 of those with a cut.")
      .def(
          "cut",
          [](nb::handle self, std::size_t i) {
            const std::span<const std::uint16_t> cut = nb::cast<const PythonFrame&>(self).draw(i).cut;
            return rows_view<const std::uint16_t, 3>(cut.data(), cut.size() / 3, self);
          },
          "draw"_a,
          "(m, 3) uint16, ids into Hlod.within_positions(node): what was drawn instead of ranges where the node was\n"
          "refined within; else empty.")
      .def_prop_ro(
          "ranges",
          [](nb::handle self) {
            const auto& ranges = nb::cast<const PythonFrame&>(self).frame.ranges;
            static_assert(offsetof(hlod::DrawRange, index_count) == 4 && sizeof(hlod::DrawRange) == 12);
            return rows_view<const std::uint32_t, 2>(ranges.empty() ? nullptr : &ranges[0].first_index, ranges.size(),
                                                     self, 3);
          },
          "(r, 2) uint32: first index and number of indices, in the triangles of the node's mesh as one list.")
      .def_prop_ro(
          "morphs",
          [](nb::handle self) {
            const auto& ranges = nb::cast<const PythonFrame&>(self).frame.ranges;
            return values_view<const float>(ranges.empty() ? nullptr : &ranges[0].morph, ranges.size(), self, 3);
          },
          "(r,) float32: how far vertices have gone to where merged_into says, 0 to 1.")
      .def_prop_ro(
          "stats", [](const PythonFrame& f) { return f.frame.stats; }, "Of this frame.")
      .def_prop_ro(
          "times", [](const PythonFrame& f) { return f.frame.times; }, "Of this frame.")
      .def_prop_ro(
          "front_hash", [](const PythonFrame& f) { return f.frame.front_hash; },
          "Of the patches and cuts drawn, in any order.");
}

}  // namespace

std::vector<HlodObject> to_hlods(nb::handle objects) {
  std::vector<HlodObject> result;
  const auto add = [&](nb::handle item) {
    if (nb::isinstance<HlodObject>(item)) {
      result.push_back(nb::cast<const HlodObject&>(item));
    } else if (nb::isinstance<Hlod>(item)) {
      const auto& hlod = nb::cast<const Hlod&>(item);
      result.push_back({hlod, positions_to_world(glm::dmat4(1.0), hlod.data().origin), false, ""});
    } else {
      return false;
    }
    return true;
  };
  if (add(objects)) return result;
  for (const nb::handle item : nb::iter(objects))
    if (!add(item)) throw nb::type_error("objects: give an HlodObject, an Hlod, or a sequence of them");
  return result;
}

void bind_traverse(nb::module_& m) {
  bind_traverse_enums(m);
  bind_traverse_options(m);
  bind_traverse_frame(m);
  nb::class_<HlodObject>(m, "HlodObject", "An HLOD at a place. Several may share an HLOD.")
      .def(
          "__init__",
          [](HlodObject* self, const Hlod& hlod, const std::optional<ArrayLike>& transform, bool two_sided) {
            const glm::dmat4 matrix = transform ? to_matrix(*transform, "transform")
                                                : positions_to_world(glm::dmat4(1.0), hlod.data().origin);
            new (self) HlodObject{hlod, matrix, two_sided, ""};
          },
          "hlod"_a, "transform"_a = nb::none(), nb::kw_only(), "two_sided"_a = false,
          "`transform`: (4, 4), positions to world, affine and invertible; multiplies columns from the left. None "
          "moves\n"
          "by the HLOD's origin, so that world space is that of the file's coordinates.")
      .def_prop_ro("hlod", [](const HlodObject& o) { return o.hlod; })
      .def_prop_ro(
          "transform", [](const HlodObject& o) { return from_matrix(o.object_to_world); },
          nb::sig("def transform(self) -> numpy.typing.NDArray[numpy.float64]"), "(4, 4) float64. A copy.")
      .def_ro("two_sided", &HlodObject::two_sided)
      .def_ro("source_name", &HlodObject::source_name, "Of objects of a scene: a file, or the scene.");
  nb::class_<PythonTraverser>(
      m, "Traverser",
      "Draws HLODs front to back, refined and culled by occlusion queries. Remembers from frame to\n"
      "frame what was visible. Calls from several threads wait for each other.")
      .def(
          "__init__", [](PythonTraverser* self, nb::object objects) { new (self) PythonTraverser(to_hlods(objects)); },
          "objects"_a,
          nb::sig(
              "def __init__(self, objects: HlodObject | Hlod | collections.abc.Iterable[HlodObject | Hlod]) -> None"))
      .def(
          "draw_frame", &draw_frame, "view"_a, "device"_a, "options"_a = nb::none(),
          "Draws one frame. What commands cost, which nohc, batch and automatic go by, is measured when first needed.\n"
          "Error for options out of their range.")
      .def(
          "set_transform",
          [](PythonTraverser& t, std::size_t object, const ArrayLike& transform) {
            const glm::dmat4 matrix = to_matrix(transform, "transform");
            const ReleasedGil release;
            const std::scoped_lock lock(t.in_use);
            t.traverser.set_transform(object, matrix);
          },
          "object"_a, "transform"_a, "Moves an object; what is known of its visibility is kept.")
      .def(
          "reset",
          [](PythonTraverser& t) {
            const ReleasedGil release;
            const std::scoped_lock lock(t.in_use);
            t.traverser.reset();
          },
          "Forgets what was visible.");
}

}  // namespace occlod::python
