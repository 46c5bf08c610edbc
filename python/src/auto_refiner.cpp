// Refinement that chooses its effects, and what it chooses by.
#include "occlod/auto_refiner.h"

#include <nanobind/operators.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "arrays.h"
#include "refining.h"
#include "text.h"

namespace occlod::python {
namespace {

using namespace nb::literals;
using State = RefinerState<AutoRefiner>;

struct PythonAutoRefiner {
  std::shared_ptr<State> state;
};

std::vector<std::unique_ptr<Visibility>> make_backends(const std::vector<std::string>& names) {
  std::vector<std::unique_ptr<Visibility>> backends;
  for (const std::string& name : names) backends.push_back(make_visibility(name));
  return backends;
}

struct PythonForecast {
  std::optional<std::string> backend;
  EffectForecast forecast;
  bool chosen = false;
};

struct PythonEffectReport {
  std::vector<PythonForecast> forecasts;
  std::optional<std::string> backend;
  EffectReport report;
};

std::optional<std::string> backend_name(const AutoRefiner& refiner, const std::optional<std::size_t>& index) {
  if (!index) return std::nullopt;
  return std::string(refiner.backend(*index).name());
}

PythonEffectReport report_of(const AutoRefiner& refiner) {
  const EffectReport& report = refiner.report();
  PythonEffectReport result{{}, backend_name(refiner, report.choice.backend), report};
  for (const EffectForecast& forecast : report.forecasts)
    result.forecasts.push_back(
        {backend_name(refiner, forecast.backend), forecast, forecast.backend == report.choice.backend});
  return result;
}

template <bool going_on>
std::shared_ptr<Result> refine(const PythonAutoRefiner& self, const ViewLike& view, std::optional<std::size_t> budget,
                               const std::optional<RefineOptions>& options) {
  State& state = *self.state;
  const View seen = view.get();
  const RefineOptions chosen = to_options(options, budget);
  return run(
      self.state, [&] { return std::unique_lock(state.in_use); },
      [&]() -> const Refinement& {
        return going_on ? state.refiner.update(seen, chosen) : state.refiner.refine(seen, chosen);
      });
}

void bind_calibration(nb::module_& m) {
  nb::class_<BackendCosts>(m, "BackendCosts", "Costs of one backend, nanoseconds, all > 0.")
      .def_ro("name", &BackendCosts::name)
      .def_rw("occluder_triangle_ns", &BackendCosts::occluder_triangle_ns)
      .def_rw("occluder_fragment_ns", &BackendCosts::occluder_fragment_ns)
      .def_rw("occluder_pixel_ns", &BackendCosts::occluder_pixel_ns)
      .def_rw("query_ns", &BackendCosts::query_ns)
      .def_rw("latency_ns", &BackendCosts::latency_ns);
  nb::class_<Calibration>(m, "Calibration",
                          "What the parts of a frame cost on one machine, nanoseconds. A program that draws otherwise\n"
                          "sets its own triangle_ns and fragment_ns.")
      .def_static(
          "measure",
          [](const std::vector<std::string>& backends) {
            const auto made = make_backends(backends);
            const ReleasedGil release;
            return measure_calibration(made);
          },
          "backends"_a = std::vector<std::string>{"software"}, "On this machine, now: some 150 ms.")
      .def_static(
          "read",
          [](const std::filesystem::path& path) {
            const ReleasedGil release;
            return read_calibration(path);
          },
          "path"_a, "From JSON. Error names the file and the place of what is missing, unknown or wrong.")
      .def(
          "write", [](const Calibration& c, const std::filesystem::path& path) { write_calibration(path, c); },
          "path"_a, "As JSON, with every digit.")
      .def_rw("visit_ns", &Calibration::visit_ns)
      .def_rw("far_visit_ns", &Calibration::far_visit_ns)
      .def_rw("cone_ns", &Calibration::cone_ns)
      .def_rw("split_ns", &Calibration::split_ns)
      .def_rw("kept_split_ns", &Calibration::kept_split_ns)
      .def_rw("triangle_ns", &Calibration::triangle_ns, "Drawing one triangle.")
      .def_rw("fragment_ns", &Calibration::fragment_ns, "Drawing one fragment.")
      .def_prop_ro(
          "backends", [](const Calibration& c) { return c.backends; }, "Copies.")
      .def(nb::self == nb::self);
}

void bind_report(nb::module_& m) {
  nb::class_<PythonForecast>(m, "EffectForecast", "What queries of one backend are expected to cost and give.")
      .def_ro("backend", &PythonForecast::backend, "Its name, or None where nothing is asked.")
      .def_ro("chosen", &PythonForecast::chosen)
      .def_prop_ro(
          "frame_ms", [](const PythonForecast& f) { return f.forecast.frame_ms; }, "Refinement, occlusion and drawing.")
      .def_prop_ro("occlusion_ms", [](const PythonForecast& f) { return f.forecast.occlusion_ms; })
      .def_prop_ro(
          "error", [](const PythonForecast& f) { return f.forecast.error; },
          "Relative to that without occlusion at the same budget.")
      .def_prop_ro(
          "score", [](const PythonForecast& f) { return f.forecast.score(); }, "The smaller the better.");
  nb::class_<PythonEffectReport>(m, "EffectReport", "What was chosen for a view, and why.")
      .def_ro("backend", &PythonEffectReport::backend, "Its name, or None where nothing was asked.")
      .def_ro("forecasts", &PythonEffectReport::forecasts, "Of everything that could have been chosen.")
      .def_prop_ro(
          "held", [](const PythonEffectReport& r) { return r.report.held; },
          "Another choice scores better, but not by enough.")
      .def_prop_ro("looked_ahead", [](const PythonEffectReport& r) { return r.report.looked_ahead; })
      .def_prop_ro("looked_back", [](const PythonEffectReport& r) { return r.report.looked_back; })
      .def_prop_ro("look_ms", [](const PythonEffectReport& r) { return r.report.look_ms; });
}

}  // namespace

void bind_auto_refiner(nb::module_& m) {
  bind_calibration(m);
  bind_report(m);
  nb::class_<PythonAutoRefiner>(
      m, "AutoRefiner",
      "A Refiner that asks about occlusion only where that is expected to pay. It learns from\n"
      "view to view; the same calibration, objects, views and options give the same meshes.")
      .def(
          "__init__",
          [](PythonAutoRefiner* self, nb::object objects, const std::optional<Calibration>& calibration,
             const std::vector<std::string>& backends) {
            std::vector<PlacedObject> placed = to_objects(objects);
            std::vector<std::unique_ptr<Visibility>> made = make_backends(backends);
            const ReleasedGil release;
            new (self) PythonAutoRefiner{std::make_shared<State>(std::move(placed), calibration, std::move(made))};
          },
          "objects"_a, nb::kw_only(), "calibration"_a = nb::none(), "backends"_a = std::vector<std::string>{"software"},
          nb::sig("def __init__(self, objects: Object | Hierarchy | collections.abc.Iterable[Object | Hierarchy], *, "
                  "calibration: Calibration | None = None, backends: collections.abc.Sequence[str] = ('software',)) -> "
                  "None"),
          "Without a calibration it is measured, some 150 ms. `backends`: names of those to choose from.")
      .def_prop_ro(
          "calibration", [](const PythonAutoRefiner& r) { return r.state->refiner.calibration(); }, "A copy.")
      .def_prop_ro("base_triangles", [](const PythonAutoRefiner& r) { return r.state->refiner.base_triangles(); })
      .def_prop_ro("full_triangles", [](const PythonAutoRefiner& r) { return r.state->refiner.full_triangles(); })
      .def("set_transform", &set_transform<PythonAutoRefiner>, "object"_a, "transform"_a, "As Refiner.set_transform().")
      .def("refine", &refine<false>, "view"_a, "budget"_a = nb::none(), "options"_a = nb::none(),
           "As Refiner.refine(), with effects chosen for the view.")
      .def("update", &refine<true>, "view"_a, "budget"_a = nb::none(), "options"_a = nb::none(),
           "As Refiner.update(), with effects chosen for the view.")
      .def(
          "report",
          [](const PythonAutoRefiner& r) {
            const ReleasedGil release;
            const std::scoped_lock lock(r.state->in_use);
            return report_of(r.state->refiner);
          },
          "About the last view. A copy.");
}

}  // namespace occlod::python
