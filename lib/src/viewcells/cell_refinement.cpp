#include "viewcells/cell_refinement.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>

#include "math/unite.h"

namespace occlod {
namespace {

Box box_of(const SplitStar& star, std::span<const glm::vec3> positions) {
  Box box{positions[star.vertex()], positions[star.vertex()]};
  star.for_each_face([&](const Triangle& t) {
    for (int k = 0; k < 3; ++k) box = unite(box, {positions[t[k]], positions[t[k]]});
  });
  return box;
}

}  // namespace

CellRefinement::CellRefinement(std::span<const RefineObject> objects, const CellSurface* surface,
                               const CellOptions& options, const Without& without)
    : objects_(objects.begin(), objects.end()), options_(options), without_(without) {
  for (const RefineObject& object : objects) {
    object.hierarchy->require_all();
    cuts_.emplace_back(*object.hierarchy);
  }
  if (surface != nullptr) hull_test_.emplace(*surface);
  result_.objects.resize(objects.size());
}

const CellCut& CellRefinement::build(const CellBox& cell) {
  result_.stats = {};
  result_.triangles = result_.drawn_triangles = 0;
  result_.error_px = 0.0;
  blocker_ = no_id;
  if (hull_test_) hull_test_->set_cell(cell, without_.near ? 0.0 : options_.eyes.near / options_.eyes.cos_corner_angle);
  const HullTest::Counts before = hull_test_ ? hull_test_->counts() : HullTest::Counts{};
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const CellView view(cell, options_.eyes, objects_[i].object_to_world);
    refine(i, view);
    find_drawn(i, view);
    result_.triangles += cuts_[i].triangle_count();
    result_.drawn_triangles += result_.objects[i].triangles.size();
  }
  if (hull_test_) {
    result_.stats.floods = hull_test_->counts().floods - before.floods;
    result_.stats.flood_triangles = hull_test_->counts().triangles - before.triangles;
  }
  return result_;
}

void CellRefinement::refine(std::uint32_t object, const CellView& view) {
  Cut& cut = cuts_[object];
  cut.clear();
  const std::span<const SplitId> roots = cut.hierarchy().data().roots;
  stack_.assign(roots.rbegin(), roots.rend());
  while (!stack_.empty()) {
    const SplitId s = stack_.back();
    stack_.pop_back();
    visit(object, view, s);
  }
}

void CellRefinement::visit(std::uint32_t object, const CellView& view, SplitId s) {
  const SplitNode& node = cuts_[object].hierarchy().node(s);
  ++result_.stats.nodes;
  if (is_fine(node.guaranteed_error, view.largest_scale_px(node.sphere))) {
    ++result_.stats.fine_nodes;
    return;
  }
  if (is_hidden(view, node.box(), node.guaranteed_error)) {
    ++result_.stats.hidden_nodes;
    return;
  }
  for (const SplitId child : {node.child_u, node.child_v})
    if (child != no_id) stack_.push_back(child);
  if (!cuts_[object].applied(s)) try_split(object, view, s);
}

void CellRefinement::try_split(std::uint32_t object, const CellView& view, SplitId s) {
  Cut& cut = cuts_[object];
  const Hierarchy& hierarchy = cut.hierarchy();
  const Box box = box_of(hierarchy.star(s), hierarchy.positions());
  const float error = hierarchy.node(s).guaranteed_error;
  if (is_fine(error, view.largest_scale_px(box))) {
    ++result_.stats.fine_splits;
  } else if (is_hidden(view, box, error)) {
    ++result_.stats.hidden_splits;
  } else {
    result_.stats.forced_splits += cut.closure(s).splits.size() - 1;
    cut.apply_closure();
  }
}

bool CellRefinement::is_fine(float error, float scale_px) {
  const double px = static_cast<double>(error) * static_cast<double>(scale_px);
  if (!(px <= options_.tolerance_px)) return false;
  result_.error_px = std::max(result_.error_px, px);
  return true;
}

bool CellRefinement::is_hidden(const CellView& view, const Box& box, float error) {
  if (!hull_test_) return false;
  const double growth =
      without_.growth ? 0.0 : std::min(static_cast<double>(error), options_.tolerance_px / view.smallest_scale_px(box));
  ++result_.stats.queries;
  const bool hidden = hull_test_->hides(view.world_box(box, growth), blocker_);
  result_.stats.queries_hidden += hidden ? 1 : 0;
  return hidden;
}

bool CellRefinement::is_seen(std::uint32_t object, const CellView& view, const Triangle& t, float error) {
  const std::span<const glm::vec3> positions = cuts_[object].hierarchy().positions();
  const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
  if (!objects_[object].two_sided && view.faces_away(a, b, c)) return false;
  return !is_hidden(view, bounding_box(std::array{a, b, c}), error);
}

void CellRefinement::find_drawn(std::uint32_t object, const CellView& view) {
  Cut& cut = cuts_[object];
  const Hierarchy& hierarchy = cut.hierarchy();
  CellObjectCut& result = result_.objects[object];
  cut.active_triangles(active_, true);  // sorts its splits
  result.applied.assign(cut.applied_splits().begin(), cut.applied_splits().end());
  result.triangles.clear();
  cut.for_each_active([&](const FaceRef& ref, const Triangle& t) {
    const float error = ref.split == no_id ? hierarchy.error_bound() : hierarchy.node(ref.split).guaranteed_error;
    if (is_seen(object, view, t, error)) result.triangles.push_back(t);
  });
}

}  // namespace occlod
