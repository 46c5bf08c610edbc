// Whether a query is worth its time: Guthe, Balazs and Klein 2006, secs. 3.2, 4.1 and 4.2.
#pragma once

#include "occlod/device/device_costs.h"
#include "occlod/traverse/occlusion_probability.h"

namespace occlod::hlod {

// What drawing takes of a device's stages.
struct DrawWork {
  double draws = 0.0;
  double triangles = 0.0;
  double fragments = 0.0;

  DrawWork& operator+=(const DrawWork& other) noexcept {
    draws += other.draws;
    triangles += other.triangles;
    fragments += other.fragments;
    return *this;
  }
};
[[nodiscard]] inline DrawWork operator*(double share, const DrawWork& work) noexcept {
  return {share * work.draws, share * work.triangles, share * work.fragments};
}

// t_r: the slowest stage decides.
[[nodiscard]] double draw_time_ns(const DeviceCosts& costs, const DrawWork& work) noexcept;
// t_o, for a box that covers so many pixels. Not printed; by analogy with t_r.
[[nodiscard]] double query_time_ns(const DeviceCosts& costs, double box_pixels) noexcept;

// Of one node.
struct QueryValue {
  double draw_ns = 0.0;   // t_r of what is below it
  double query_ns = 0.0;  // t_o: what asking costs
  double benefit_ns = 0.0;
};
// depth: of the hierarchy, > 0: benefits add up over its levels.
[[nodiscard]] QueryValue query_value(double draw_ns, double query_ns, double occlusion_probability,
                                     double depth) noexcept;

// What the test has to know of a node beside its value.
struct AskedBefore {
  LastSight last = LastSight::outside;
  double occlusion_probability = 0.0;
  double frames_since_asked = 0.0;  // n_q; of a node that was never asked about, since it was first seen
};

// Of the node's children together; those outside the frustum are left out, so they cost nothing.
struct ChildrenValue {
  double query_ns = 0.0;
  double benefit_ns = 0.0;
  double leaves = 0.0;         // N_l: nodes that are drawn below the node
  bool any_unaskable = false;  // one whose drawing takes less than its query
};

// The paper's fig. 5 with sec. 4.1. Its figure sums over the children of leaves too, so that those would never be asked
// about; here both tests of children are for inner nodes. `children` is null for a leaf.
[[nodiscard]] bool is_query_reasonable(const DeviceCosts& costs, const QueryValue& node, const AskedBefore& before,
                                       const ChildrenValue* children) noexcept;

// N_q: so many queries after one was asked, it must be answered.
[[nodiscard]] double most_parallel_queries(const DeviceCosts& costs) noexcept;

}  // namespace occlod::hlod
