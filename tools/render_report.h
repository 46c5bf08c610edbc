// What `occlod render` says about a refined view.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "backend.h"
#include "json_output.h"
#include "occlod/picture/compare.h"
#include "occlod/refine/refiner.h"
#include "render_input.h"

namespace occlod::tool {

// Medians over all repetitions.
struct RenderTimes {
  double refine_ms = 0.0;
  double occlusion_ms = 0.0;
  double draw_ms = 0.0;
};

struct RenderResult {
  const RenderInput& input;
  const RefineOptions& options;
  const Backend& backend;
  const Refinement& refinement;
  std::size_t visible_triangles;
  RenderTimes times;
  std::optional<PictureDistance> distance;       // to the full mesh
  std::optional<std::size_t> wrongly_hidden_px;  // see accuracy.h
};

[[nodiscard]] Json report_of(const RenderResult& result);

[[nodiscard]] const char* name_of(Culling culling);
[[nodiscard]] const char* name_of(Proxy proxy);

}  // namespace occlod::tool
