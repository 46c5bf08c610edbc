// The views that refinement is timed in: those of the scenes planet_full and planet_near.
#pragma once

#include <array>
#include <string_view>

#include "occlod/view.h"

namespace occlod::bench {

struct NamedCamera {
  std::string_view name;
  Camera camera;
};

[[nodiscard]] inline std::array<NamedCamera, 2> planet_views() {
  Camera whole;
  whole.eye = {0.4, 0.7, 2.9};
  whole.near = 0.1;
  whole.far = 20.0;
  Camera near;
  near.eye = {0.0, 1.12, 0.0};
  near.target = {0.0, 0.98, -0.4};
  near.fov_y_deg = 60.0;
  near.near = 0.005;
  near.far = 10.0;
  return {{{"whole", whole}, {"near", near}}};
}

}  // namespace occlod::bench
