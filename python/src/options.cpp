// Options of refinement.
#include <nanobind/operators.h>
#include <nanobind/stl/tuple.h>

#include <tuple>

#include "arrays.h"
#include "bindings.h"
#include "occlod/refiner.h"

namespace occlod::python {
namespace {

using namespace nb::literals;

// For pickling.
using OptionsState = std::tuple<std::size_t, double, Method, OccluderMode, std::size_t, double, std::uint32_t, int>;

void bind_enums(nb::module_& m) {
  nb::enum_<Method>(m, "Method", "How a mesh is refined.")
      .value("occlod", Method::occlod, "Our own.")
      .value("paper", Method::paper, "As Birkholz & Rahn published it, to compare with.");
  nb::enum_<OccluderMode>(m, "OccluderMode", "What the current mesh hides.")
      .value("paper", OccluderMode::paper, "Whatever is behind its triangles as they are.")
      .value("conservative", OccluderMode::conservative, "Only what stays hidden wherever the true surface may be.");
}

}  // namespace

void bind_options(nb::module_& m) {
  bind_enums(m);
  const RefineOptions standard;
  nb::class_<RefineOptions>(m, "RefineOptions", "All that can be set for one call, but for effects by object.")
      .def(
          "__init__",
          [](RefineOptions* self, std::size_t budget, double tolerance_px, Method method, OccluderMode mode,
             std::size_t max_changes, double time_limit_ms, std::uint32_t geomorph_frames, int threads) {
            new (self) RefineOptions{.budget = budget,
                                     .tolerance_px = tolerance_px,
                                     .method = method,
                                     .mode = mode,
                                     .max_changes = max_changes,
                                     .time_limit_ms = time_limit_ms,
                                     .geomorph_frames = geomorph_frames,
                                     .threads = threads};
          },
          nb::kw_only(), "budget"_a = standard.budget, "tolerance_px"_a = standard.tolerance_px,
          "method"_a = standard.method, "mode"_a = standard.mode, "max_changes"_a = standard.max_changes,
          "time_limit_ms"_a = standard.time_limit_ms, "geomorph_frames"_a = standard.geomorph_frames,
          "threads"_a = standard.threads)
      .def_rw("budget", &RefineOptions::budget, "Triangles over all objects, never exceeded.")
      .def_rw("tolerance_px", &RefineOptions::tolerance_px,
              "Stop when no visible split has a larger bound on its screen error; 0: spend the budget.")
      .def_rw("method", &RefineOptions::method)
      .def_rw("mode", &RefineOptions::mode, "What occluders hide.")
      .def_rw("max_changes", &RefineOptions::max_changes, "update() only: splits and merges in one call; 0: no limit.")
      .def_rw("time_limit_ms", &RefineOptions::time_limit_ms,
              "update() only: no further changes after so long; 0: no limit.")
      .def_rw("geomorph_frames", &RefineOptions::geomorph_frames,
              "update() only: calls in which a new vertex slides from its parent to its place; 0: at once.")
      .def_rw("threads", &RefineOptions::threads,
              "That refinement from scratch may use; 0: one for each core. The result does not depend on it.")
      .def(nb::self == nb::self)
      .def("__getstate__",
           [](const RefineOptions& o) {
             return OptionsState(o.budget, o.tolerance_px, o.method, o.mode, o.max_changes, o.time_limit_ms,
                                 o.geomorph_frames, o.threads);
           })
      .def("__setstate__", [](RefineOptions& self, const OptionsState& state) {
        RefineOptions made;
        std::tie(made.budget, made.tolerance_px, made.method, made.mode, made.max_changes, made.time_limit_ms,
                 made.geomorph_frames, made.threads) = state;
        new (&self) RefineOptions(made);
      });
}

}  // namespace occlod::python
