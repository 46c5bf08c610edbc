#include "hlod/draw/query_value.h"

#include <algorithm>
#include <cmath>

namespace occlod::hlod {

double draw_time_ns(const DeviceCosts& costs, const DrawWork& work) noexcept {
  return std::max({work.draws * costs.draw_ns, work.triangles * costs.triangle_ns, work.fragments * costs.fragment_ns});
}

double query_time_ns(const DeviceCosts& costs, double box_pixels) noexcept {
  return std::max(costs.query_ns, box_pixels * costs.query_fragment_ns);
}

QueryValue query_value(double draw_ns, double query_ns, double occlusion_probability, double depth) noexcept {
  return {draw_ns, query_ns, occlusion_probability * (draw_ns - query_ns) / depth};
}

bool is_query_reasonable(const DeviceCosts& costs, const QueryValue& node, const AskedBefore& before,
                         const ChildrenValue* children) noexcept {
  if (node.draw_ns < node.query_ns) return false;
  if (children != nullptr && children->query_ns < node.query_ns) return false;
  if (before.last == LastSight::hidden) return true;
  if (before.last == LastSight::outside)
    return node.query_ns + (1.0 - before.occlusion_probability) * node.draw_ns < node.draw_ns;
  if (node.query_ns > before.frames_since_asked * node.benefit_ns) return false;
  if (children == nullptr || children->any_unaskable) return true;
  return node.benefit_ns > children->benefit_ns && costs.wrapped_query_ns * children->leaves > node.query_ns;
}

double most_parallel_queries(const DeviceCosts& costs) noexcept {
  const double least = std::min(costs.query_ns, costs.wrapped_query_ns + costs.draw_ns);
  return least > 0.0 ? std::ceil((costs.query_ns + costs.readback_ns) / least) + 1.0 : 1.0;
}

}  // namespace occlod::hlod
