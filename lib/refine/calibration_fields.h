// The numbers of a calibration by name.
#pragma once

#include "occlod/effects/calibration.h"

namespace occlod {

// Calls visit(key, value) for each number. `Costs` may be const.
template <typename Costs, typename Visit>
void for_each_backend_cost(Costs& costs, const Visit& visit) {
  visit("occluder_triangle_ns", costs.occluder_triangle_ns);
  visit("occluder_fragment_ns", costs.occluder_fragment_ns);
  visit("occluder_pixel_ns", costs.occluder_pixel_ns);
  visit("query_ns", costs.query_ns);
  visit("latency_ns", costs.latency_ns);
}
template <typename Costs, typename Visit>
void for_each_cost(Costs& costs, const Visit& visit) {
  visit("visit_ns", costs.visit_ns);
  visit("far_visit_ns", costs.far_visit_ns);
  visit("cone_ns", costs.cone_ns);
  visit("split_ns", costs.split_ns);
  visit("kept_split_ns", costs.kept_split_ns);
  visit("triangle_ns", costs.triangle_ns);
  visit("fragment_ns", costs.fragment_ns);
}

}  // namespace occlod
