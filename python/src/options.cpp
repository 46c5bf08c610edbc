// Options of refinement.
#include <nanobind/operators.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "bindings.h"
#include "occlod/refiner.h"
#include "refine/tuning.h"

namespace occlod::python {
namespace {

using namespace nb::literals;

void bind_enums(nb::module_& m) {
  nb::enum_<Culling>(m, "Culling", "Which question decides that a split is applied.")
      .value("subtree", Culling::subtree, "As in the paper: may the bounds of its subtree be seen?")
      .value("star", Culling::star, "Descend where those may be seen, apply where the split's own faces may be.");
  nb::enum_<Proxy>(m, "Proxy", "The bounds of a subtree that occlusion queries ask about.")
      .value("sphere", Proxy::sphere)
      .value("box", Proxy::box)
      .value("cylinder", Proxy::cylinder);
  nb::enum_<OccluderMode>(m, "OccluderMode", "What the current mesh hides.")
      .value("paper", OccluderMode::paper, "Whatever is behind its triangles as they are.")
      .value("conservative", OccluderMode::conservative, "Only what stays hidden wherever the true surface may be.");
}

void bind_parts(nb::module_& m) {
  const PriorityOptions priority;
  nb::class_<PriorityOptions>(m, "PriorityOptions", "What a split is worth in a view.")
      .def(
          "__init__",
          [](PriorityOptions* self, Culling culling, double visible, double grazing, double forced) {
            new (self) PriorityOptions{culling, visible, grazing, forced};
          },
          nb::kw_only(), "culling"_a = priority.culling, "visible_exponent"_a = priority.visible_exponent,
          "grazing_exponent"_a = priority.grazing_exponent, "forced_exponent"_a = priority.forced_exponent)
      .def_rw("culling", &PriorityOptions::culling)
      .def_rw("visible_exponent", &PriorityOptions::visible_exponent, "In [0, 8].")
      .def_rw("grazing_exponent", &PriorityOptions::grazing_exponent, "In [0, 8].")
      .def_rw("forced_exponent", &PriorityOptions::forced_exponent, "In [0, 8].")
      .def(nb::self == nb::self);

  const OccluderOptions occluder;
  nb::class_<OccluderOptions>(m, "OccluderOptions", "When and how the current mesh is drawn as an occluder.")
      .def(
          "__init__",
          [](OccluderOptions* self, OccluderMode mode, std::vector<std::uint32_t> splits, bool retest_hidden) {
            new (self) OccluderOptions{mode, std::move(splits), retest_hidden};
          },
          nb::kw_only(), "mode"_a = occluder.mode, "splits"_a = std::vector<std::uint32_t>(),
          "retest_hidden"_a = occluder.retest_hidden)
      .def_rw("mode", &OccluderOptions::mode)
      .def_rw("splits", &OccluderOptions::splits,
              "From scratch: draw it when so many splits are applied; ascending. Empty: as often as it pays. A copy:\n"
              "assign a list.")
      .def_rw("retest_hidden", &OccluderOptions::retest_hidden,
              "From scratch: ask again about what an older occluder hid.")
      .def(nb::self == nb::self);

  const QueryOptions queries;
  nb::class_<QueryOptions>(m, "QueryOptions", "What is asked about occlusion.")
      .def(
          "__init__",
          [](QueryOptions* self, Proxy proxy, std::uint32_t level_step, bool ask_stars, bool final_check) {
            new (self) QueryOptions{proxy, level_step, ask_stars, final_check};
          },
          nb::kw_only(), "proxy"_a = queries.proxy, "level_step"_a = queries.level_step,
          "ask_stars"_a = queries.ask_stars, "final_check"_a = queries.final_check)
      .def_rw("proxy", &QueryOptions::proxy)
      .def_rw("level_step", &QueryOptions::level_step, "Ask about subtrees on every n-th forest level; >= 1.")
      .def_rw("ask_stars", &QueryOptions::ask_stars, "Ask about each split's own faces before it is applied.")
      .def_rw("final_check", &QueryOptions::final_check, "Ask again about all that is hidden before the result.")
      .def(nb::self == nb::self);

  const UpdateOptions update;
  nb::class_<UpdateOptions>(m, "UpdateOptions", "update() only: how fast the mesh may follow the camera.")
      .def(
          "__init__",
          [](UpdateOptions* self, double hysteresis, std::size_t max_changes, double time_limit_ms,
             std::uint32_t geomorph_frames) {
            new (self) UpdateOptions{hysteresis, max_changes, time_limit_ms, geomorph_frames};
          },
          nb::kw_only(), "hysteresis"_a = update.hysteresis, "max_changes"_a = update.max_changes,
          "time_limit_ms"_a = update.time_limit_ms, "geomorph_frames"_a = update.geomorph_frames)
      .def_rw("hysteresis", &UpdateOptions::hysteresis,
              "Relative margin by which a candidate must exceed an applied split to replace it; in [0, 1).")
      .def_rw("max_changes", &UpdateOptions::max_changes, "Splits and merges in one call; 0: no limit.")
      .def_rw("time_limit_ms", &UpdateOptions::time_limit_ms, "No further changes after so long; 0: no limit.")
      .def_rw("geomorph_frames", &UpdateOptions::geomorph_frames,
              "Calls in which a new vertex slides from its parent to its place; 0: at once.")
      .def(nb::self == nb::self);
}

}  // namespace

void bind_options(nb::module_& m) {
  bind_enums(m);
  bind_parts(m);
  const RefineOptions standard;
  nb::class_<RefineOptions>(m, "RefineOptions",
                            "All that can be set for one call, but for effects by object. Its parts may be changed in\n"
                            "place: tune(options).proxy = Proxy.sphere.")
      .def(
          "__init__",
          [](RefineOptions* self, std::size_t budget, double tolerance_px, const PriorityOptions& priority,
             const OccluderOptions& occluder, const QueryOptions& queries, const UpdateOptions& update, int threads) {
            new (self) RefineOptions{budget, tolerance_px, priority, occluder, queries, update, threads, {}};
          },
          nb::kw_only(), "budget"_a = standard.budget, "tolerance_px"_a = standard.tolerance_px,
          "priority"_a = standard.priority, "occluder"_a = standard.occluder, "queries"_a = standard.queries,
          "update"_a = standard.update, "threads"_a = standard.threads,
          nb::sig(
              "def __init__(self, *, budget: int = 10000, tolerance_px: float = 0.0, priority: PriorityOptions = ..., "
              "occluder: OccluderOptions = ..., queries: QueryOptions = ..., update: UpdateOptions = ..., "
              "threads: int = 1) -> None"))
      .def_rw("budget", &RefineOptions::budget, "Triangles over all objects, never exceeded.")
      .def_rw("tolerance_px", &RefineOptions::tolerance_px,
              "Stop when no visible split has a larger bound on its screen error; 0: spend the budget.")
      .def_rw("priority", &RefineOptions::priority)
      .def_rw("occluder", &RefineOptions::occluder)
      .def_rw("queries", &RefineOptions::queries)
      .def_rw("update", &RefineOptions::update)
      .def_rw("threads", &RefineOptions::threads,
              "That refinement from scratch may use; 0: one for each core. The result does not depend on it.")
      .def(nb::self == nb::self);
}

}  // namespace occlod::python
