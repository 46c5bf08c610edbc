#include "hlod/draw/front_sizes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace occlod::hlod {
namespace {

constexpr double room = 1.1;  // most that a tolerance is larger than it has to be

}  // namespace

void FrontSizes::assign(const View& view, std::span<const PlacedHlod> objects, double least_px) {
  steps_.assign(1, {least_px, 0.0});
  for (const PlacedHlod& object : objects) add(object, view, least_px);
  std::ranges::sort(steps_, {}, &Step::from_px);
  std::size_t kept = 0;
  double triangles = 0.0;
  for (const Step step : steps_) {
    triangles += step.triangles;
    if (step.from_px > steps_[kept].from_px) ++kept;
    steps_[kept] = {step.from_px, triangles};
  }
  steps_.resize(kept + 1);
}

// Parents come before their children. At a tolerance of 0 nodes are refined whose error is 0, too.
void FrontSizes::add(const PlacedHlod& object, const View& view, double least_px) {
  const Hlod& hlod = *object.hlod;
  const ObjectFrame frame(view, object);
  const auto is_there = [&](NodeId child) {
    return hlod.is_resident(child) || !frame.may_be_inside(hlod.node(child).box);
  };
  is_reached_.assign(hlod.node_count(), false);
  refined_px_.assign(hlod.node_count(), least_px);
  for (const NodeId root : hlod.data().roots) is_reached_[root] = true;
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    if (!is_reached_[n] || !frame.may_be_inside(hlod.node(n).box)) continue;
    const std::span<const NodeId> children = hlod.children(n);
    if (!children.empty() && std::ranges::all_of(children, is_there))
      refined_px_[n] = std::max({frame.error_px(hlod.node(n)), least_px, std::numeric_limits<double>::denorm_min()});
    for (const Patch& patch : hlod.patches(n)) {
      const double triangles = patch.index_count / 3.0;
      if (patch.parent != no_id && !(refined_px_[patch.parent] > refined_px_[n])) continue;
      steps_.push_back({refined_px_[n], triangles});
      if (patch.parent != no_id) steps_.push_back({refined_px_[patch.parent], -triangles});
    }
    if (refined_px_[n] > least_px)
      for (const NodeId child : children) is_reached_[child] = true;
  }
}

double FrontSizes::at(double tolerance_px) const {
  const auto after = std::ranges::upper_bound(steps_, tolerance_px, {}, &Step::from_px);
  return after == steps_.begin() ? after->triangles : std::prev(after)->triangles;
}

double FrontSizes::tolerance_px(double triangles, double above_px) const {
  const auto begin = std::ranges::upper_bound(steps_, above_px, {}, &Step::from_px);
  const auto step = std::find_if(begin, steps_.end(), [&](const Step& s) { return s.triangles <= triangles; });
  if (step == steps_.end()) return coarsest_px();
  if (step == steps_.begin() || step + 1 == steps_.end()) return step->from_px;
  return std::min(room * step->from_px, std::sqrt(step->from_px * (step + 1)->from_px));
}

}  // namespace occlod::hlod
