#include "cells/cell_refinement.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <utility>

#include "base/unite.h"
#include "refine/screen_error.h"
#include "cells/cell_geometry.h"
#include "cells/star_box.h"

namespace occlod {
namespace {

// Of faces that are asked about at once before each is: larger groups are seldom hidden.
constexpr std::size_t most_faces_at_once = 8;

}  // namespace

CellRefinement::CellRefinement(std::span<const RefineObject> objects, const CellSurface* surface,
                               const InnerBoxes* boxes, const CellOptions& options, const Without& without)
    : objects_(objects.begin(), objects.end()), options_(options), without_(without) {
  result_.objects.resize(objects.size());
  for (const RefineObject& object : objects) {
    object.hierarchy->require_all();
    cuts_.emplace_back(*object.hierarchy);
  }
  if (surface == nullptr || options.occlusion == CellOcclusion::none) return;
  hull_test_.emplace(*surface, boxes);
  images_.emplace(*surface);
}

const CellCut& CellRefinement::build(const CellBox& cell) {
  result_.stats = {};
  result_.triangles = result_.drawn_triangles = 0;
  result_.error_px = 0.0;
  if (hull_test_) {
    const double near_reach = without_.near ? 0.0 : options_.eyes.near / options_.eyes.cos_corner_angle;
    hull_test_->set_cell(cell, near_reach);
    images_->draw(cell, near_reach);
  }
  const HullTest::Counts before = hull_test_ ? hull_test_->counts() : HullTest::Counts{};
  views_.clear();
  triangles_ = 0;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    views_.emplace_back(cell, options_.eyes, objects_[i].object_to_world);
    cuts_[i].clear();
    triangles_ += cuts_[i].triangle_count();
  }
  if (options_.budget > 0) refine_to_budget();
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    if (options_.budget == 0) refine(i, views_[i]);
    find_drawn(i, views_[i]);
    result_.triangles += cuts_[i].triangle_count();
    result_.drawn_triangles += result_.objects[i].triangles.size();
  }
  if (hull_test_) {
    result_.stats.queries_boxed = hull_test_->counts().boxed - before.boxed;
    result_.stats.floods = hull_test_->counts().floods - before.floods;
    result_.stats.flood_triangles = hull_test_->counts().triangles - before.triangles;
  }
  return result_;
}

void CellRefinement::refine(std::uint32_t object, const CellView& view) {
  const std::span<const SplitId> roots = cuts_[object].hierarchy().data().roots;
  stack_.assign(roots.rbegin(), roots.rend());
  while (!stack_.empty()) {
    const SplitId s = stack_.back();
    stack_.pop_back();
    visit(object, view, s);
  }
}

void CellRefinement::refine_to_budget() {
  heap_.clear();
  is_full_ = false;
  const auto push = [&](std::uint32_t object, SplitId s) {
    const Sphere& sphere = cuts_[object].hierarchy().node(s).sphere;
    heap_.push_back({error_of(object, s) * views_[object].largest_scale_px(sphere), object, s});
    std::push_heap(heap_.begin(), heap_.end());
  };
  for (std::uint32_t i = 0; i < objects_.size(); ++i)
    for (const SplitId root : cuts_[i].hierarchy().data().roots) push(i, root);
  while (!heap_.empty() && !is_full_) {
    std::pop_heap(heap_.begin(), heap_.end());
    const Candidate next = heap_.back();
    heap_.pop_back();
    stack_.clear();
    visit(next.object, views_[next.object], next.split);
    for (const SplitId child : stack_) push(next.object, child);
    if (!is_full_) continue;
    const float left = heap_.empty() ? next.px : std::max(next.px, heap_.front().px);
    result_.error_px = std::max(result_.error_px, static_cast<double>(left));
  }
}

void CellRefinement::visit(std::uint32_t object, const CellView& view, SplitId s) {
  const SplitNode& node = cuts_[object].hierarchy().node(s);
  ++result_.stats.nodes;
  if (is_fine(error_of(object, s), view.largest_scale_px(node.sphere))) {
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
  if (is_fine(error_of(object, s), view.largest_scale_px(box))) {
    ++result_.stats.fine_splits;
  } else if (is_hidden(view, box, hierarchy.node(s).guaranteed_error)) {
    ++result_.stats.hidden_splits;
  } else {
    const Cut::Closure closure = cut.closure(s);
    is_full_ = options_.budget > 0 && triangles_ + closure.triangles > options_.budget;
    if (is_full_) return;
    triangles_ += closure.triangles;
    result_.stats.forced_splits += closure.splits.size() - 1;
    cut.apply_closure();
  }
}

float CellRefinement::error_of(std::uint32_t object, SplitId s) const {
  return errors_of(cuts_[object].hierarchy(), s, objects_[object].attributes).guaranteed;
}

bool CellRefinement::is_fine(float error, float scale_px) {
  const double px = static_cast<double>(error) * static_cast<double>(scale_px);
  if (!(px <= options_.tolerance_px)) return false;
  result_.error_px = std::max(result_.error_px, px);
  return true;
}

CellBox CellRefinement::grown_box(const CellView& view, const Box& box, float error) const {
  double growth = without_.growth ? 0.0 : static_cast<double>(error);
  if (options_.budget == 0) growth = std::min(growth, options_.tolerance_px / view.smallest_scale_px(box));
  return view.world_box(box, growth);
}

bool CellRefinement::is_hidden(const CellView& view, const Box& box, float error) {
  return hull_test_ && is_hidden(grown_box(view, box, error));
}

bool CellRefinement::is_seen(const CellBox& what) {
  const bool seen = images_->show(what);
  result_.stats.seen_boxes += seen ? 1 : 0;
  return seen;
}

bool CellRefinement::is_hidden(const CellBox& what) {
  if (is_seen(what)) return false;
  ++result_.stats.queries;
  const bool hidden = hull_test_->hides(what);
  result_.stats.queries_hidden += hidden ? 1 : 0;
  return hidden;
}

void CellRefinement::find_drawn(std::uint32_t object, const CellView& view) {
  Cut& cut = cuts_[object];
  CellObjectCut& result = result_.objects[object];
  cut.active_wedge_triangles(active_, true);  // sorts its splits
  result.applied.assign(cut.applied_splits().begin(), cut.applied_splits().end());
  drawn_.assign(active_.size(), false);
  faces_.clear();
  std::uint32_t place = 0;
  cut.for_each_active([&](const FaceRef& ref, const Triangle& t) { add_face(object, view, ref, t, place++); });
  if (!faces_.empty()) drop_hidden(faces_);
  result.triangles.clear();
  for (std::size_t i = 0; i < active_.size(); ++i)
    if (drawn_[i]) result.triangles.push_back(active_[i]);
}

void CellRefinement::add_face(std::uint32_t object, const CellView& view, const FaceRef& ref, const Triangle& t,
                              std::uint32_t place) {
  const Hierarchy& hierarchy = cuts_[object].hierarchy();
  const std::span<const glm::vec3> positions = hierarchy.positions();
  const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
  if (!objects_[object].two_sided && view.faces_away(a, b, c)) return;
  drawn_[place] = true;
  if (!hull_test_) return;
  const float error = ref.split == no_id ? hierarchy.error_bound() : hierarchy.node(ref.split).guaranteed_error;
  const CellBox box = grown_box(view, bounding_box(std::array{a, b, c}), error);
  if (!is_seen(box)) faces_.push_back({box, place});
}

// Halves of them by place in space, like TriangleBvh.
void CellRefinement::drop_hidden(std::span<Face> faces) {
  CellBox box = faces[0].box;
  for (const Face& face : faces) box = unite(box, face.box);
  if (faces.size() <= most_faces_at_once && is_hidden(box)) {
    for (const Face& face : faces) drawn_[face.place] = false;
    return;
  }
  if (faces.size() == 1) return;
  const int axis = longest_axis(box);
  const auto key = [&](const Face& face) { return std::pair(face.box.min[axis] + face.box.max[axis], face.place); };
  const std::size_t half = faces.size() / 2;
  std::nth_element(faces.begin(), faces.begin() + static_cast<std::ptrdiff_t>(half), faces.end(),
                   [&](const Face& x, const Face& y) { return key(x) < key(y); });
  drop_hidden(faces.first(half));
  drop_hidden(faces.subspan(half));
}

}  // namespace occlod
