// Names the times of DeviceCosts.
#pragma once

#include "occlod/device_costs.h"

namespace occlod::hlod {

// Calls visit(key, value) for each time. `Costs` may be const.
template <typename Costs, typename Visit>
void for_each_device_cost(Costs& costs, const Visit& visit) {
  visit("draw_ns", costs.draw_ns);
  visit("triangle_ns", costs.triangle_ns);
  visit("fragment_ns", costs.fragment_ns);
  visit("query_ns", costs.query_ns);
  visit("query_fragment_ns", costs.query_fragment_ns);
  visit("wrapped_query_ns", costs.wrapped_query_ns);
  visit("readback_ns", costs.readback_ns);
  visit("batch_ns", costs.batch_ns);
  visit("batch_item_ns", costs.batch_item_ns);
  visit("submit_ns", costs.submit_ns);
  visit("visit_ns", costs.visit_ns);
}

}  // namespace occlod::hlod
