#include "cut_error.h"

#include <algorithm>
#include <vector>

#include "refine/star_visibility.h"

namespace occlod::oracle {
namespace {

class Walk {
 public:
  Walk(std::uint32_t object, const RefineObject& placed, const RefinedObject& refined, const ObjectView& view,
       Visibility& visibility, CutError& worst)
      : object_(object),
        hierarchy_(*placed.hierarchy),
        two_sided_(placed.two_sided),
        applied_(hierarchy_.split_count(), false),
        view_(view),
        visibility_(visibility),
        worst_(worst) {
    for (const SplitId s : refined.splits) applied_[s] = true;
  }

  void run() {
    open_.assign(hierarchy_.data().roots.begin(), hierarchy_.data().roots.end());
    while (!open_.empty()) {
      const SplitId s = open_.back();
      open_.pop_back();
      const SplitNode& node = hierarchy_.node(s);
      if (!view_.may_be_inside(node.sphere)) continue;
      // Errors shrink towards the leaves, and bounds are nested.
      if (!is_worse(node, view_.largest_scale_px(node.sphere))) continue;
      if (!applied_[s]) look_at(s);
      for (const SplitId child : {node.child_u, node.child_v})
        if (child != no_id) open_.push_back(child);
    }
  }

 private:
  [[nodiscard]] bool is_worse(const SplitNode& node, float scale_px) const {
    return node.error * scale_px > worst_.quadric_px || node.guaranteed_error * scale_px > worst_.guaranteed_px;
  }

  void look_at(SplitId s) {
    const StarView star = look_.evaluate(hierarchy_, s, view_, two_sided_);
    const SplitNode& node = hierarchy_.node(s);
    const float scale_px = view_.largest_scale_px(star.sphere);
    if (star.visible_share == 0.0F || !is_worse(node, scale_px)) return;
    if (visibility_.can_hide()) {
      visibility_.submit({object_, PointHull{look_.points(hierarchy_, s)}});
      if (visibility_.collect() == 0) return;
    }
    worst_.quadric_px = std::max(worst_.quadric_px, static_cast<double>(node.error * scale_px));
    worst_.guaranteed_px = std::max(worst_.guaranteed_px, static_cast<double>(node.guaranteed_error * scale_px));
  }

  std::uint32_t object_;
  const Hierarchy& hierarchy_;
  bool two_sided_;
  std::vector<bool> applied_;
  const ObjectView& view_;
  Visibility& visibility_;
  CutError& worst_;
  StarVisibility look_;
  std::vector<SplitId> open_;
};

}  // namespace

CutError cut_error(std::span<const RefineObject> objects, const Refinement& refinement, const View& view,
                   Visibility& visibility) {
  std::vector<ObjectView> views;
  for (const RefineObject& object : objects) views.emplace_back(view, object.object_to_world);
  if (visibility.can_hide()) {
    visibility.begin_view(view, views);
    std::vector<OccluderPart> parts;
    for (std::uint32_t i = 0; i < objects.size(); ++i)
      parts.push_back({i, objects[i].hierarchy->positions(), refinement.objects[i].triangles});
    visibility.draw_occluder(parts);
  }
  CutError worst;
  for (std::uint32_t i = 0; i < objects.size(); ++i)
    Walk(i, objects[i], refinement.objects[i], views[i], visibility, worst).run();
  return worst;
}

}  // namespace occlod::oracle
