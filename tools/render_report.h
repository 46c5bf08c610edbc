// Reports on a refined view of `occlod render`.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "json_output.h"
#include "measurement.h"
#include "occlod/compare.h"
#include "occlod/refiner.h"
#include "refine_way.h"
#include "render_input.h"

namespace occlod::tool {

struct RenderResult {
  const RenderInput& input;
  const RefineOptions& options;
  const RefineWay& way;
  const Measurement& measurement;
  std::optional<PictureDistance> distance;       // to the full mesh
  std::optional<double> texture_slip_px;         // from the full mesh, see accuracy.h
  std::optional<std::size_t> wrongly_hidden_px;  // see accuracy.h
};

[[nodiscard]] Json report_of(const RenderResult& result);
void print_report(const RenderResult& result);  // the same for people

// These are parts of the report: scene (and path), backend and options; and the last repetition, with the median times.
[[nodiscard]] Json asked_of(const RenderInput& input, const RefineOptions& options, const RefineWay& way);
[[nodiscard]] Json stats_of(const Measurement& measurement);

// These are the parts that concern Refiner::update() alone.
[[nodiscard]] Json following_asked_of(const RefineOptions& options);
[[nodiscard]] Json changes_of(const RefineStats& stats);

}  // namespace occlod::tool
