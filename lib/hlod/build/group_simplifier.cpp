#include "hlod/build/group_simplifier.h"

#include <algorithm>

#include "base/threads.h"
#include "splits/group_error.h"

namespace occlod::hlod {
namespace {

Triangle global(const Triangle& t, std::span<const std::uint32_t> ids) { return {ids[t.x], ids[t.y], ids[t.z]}; }

// Returns the corners, the smallest first.
std::array<std::uint32_t, 3> sorted(const Triangle& t) {
  std::array<std::uint32_t, 3> corners{t.x, t.y, t.z};
  std::sort(corners.begin(), corners.end());
  return corners;
}

GroupTarget target_of(const GroupInput& group, const GroupRules& rules) {
  const double least = static_cast<double>(rules.least_share) * static_cast<double>(group.mesh.triangle_count());
  return {.scale = rules.scale,
          .boundary_weight = build_weights.boundary,
          .max_cost = rules.max_cost,
          .min_triangles = static_cast<std::size_t>(least),
          .keeps_collapses = rules.keeps_splits != 0,
          .attribute_weight = build_weights.attributes,
          .keeps_bounds = rules.keeps_bounds != 0,
          .lists_bounds = rules.measures != 0,
          .refits = rules.refits != 0,
          .lattice_step = rules.lattice_step,
          .held = group.shared};
}

Box box_of(std::span<const Box> boxes) {
  Box box = boxes[0];
  for (const Box& other : boxes) box = unite(box, other);
  return box;
}

}  // namespace

float GroupSimplifier::cost_of(const GroupInput& group, const GroupRules& rules) {
  GroupTarget target = target_of(group, rules);
  target.keeps_collapses = target.keeps_bounds = target.lists_bounds = target.refits = false;
  return simplify_group(group.mesh, group.locked, target).cost;
}

SimplifiedNode GroupSimplifier::run(const GroupInput& group, const GroupRules& rules) {
  group_ = &group;
  simplified_ = simplify_group(group.mesh, group.locked, target_of(group, rules));
  SimplifiedNode result;
  result.error = simplified_.error;
  result.guaranteed_error =
      rules.measures != 0 ? measured_error(group.mesh, simplified_) : simplified_.guaranteed_error;
  if (rules.keeps_bounds != 0) result.box = box_of(group.boxes);
  for (const glm::vec3& p : simplified_.positions) result.box = unite(result.box, {p, p});
  for (const Triangle& t : simplified_.triangles) result.triangles.push_back(global(t, group.vertices));
  add_wedges(result, rules.first_added);
  if (rules.names_wedges != 0)
    for (const Triangle& t : simplified_.corners.empty() ? simplified_.triangles : simplified_.corners)
      result.corners.push_back(global(t, images_));
  list_lost(result);
  if (rules.keeps_bounds == 0) return result;
  list_merges(result);
  list_vanished(result);
  if (!simplified_.collapses.empty() && wedges_.size() <= stays && can_replay()) keep_splits(result.within);
  return result;
}

// Adds the wedges that simplification has added, and those of vertices that have moved.
void GroupSimplifier::add_wedges(SimplifiedNode& result, WedgeId first_added) {
  const std::vector<glm::vec3>& positions =
      simplified_.positions.empty() ? group_->mesh.positions : simplified_.positions;
  const auto add = [&](VertexId vertex, WedgeId like) {
    result.added.push_back({group_->vertices[vertex], like, positions[vertex]});
    return static_cast<WedgeId>(first_added + result.added.size() - 1);
  };
  wedges_ = group_->wedges;
  for (const AddedWedge& added : simplified_.added) wedges_.push_back(add(added.vertex, wedges_[added.attributes]));
  images_ = wedges_;
  if (simplified_.positions.empty()) return;
  for (WedgeId w = 0; w < group_->wedges.size(); ++w) {
    const VertexId v = group_->mesh.vertex_of(w);
    if (simplified_.merged_into[w] == w && positions[v] != group_->mesh.positions[v]) images_[w] = add(v, wedges_[w]);
  }
}

void GroupSimplifier::list_merges(SimplifiedNode& result) {
  used_.assign(wedges_.size(), 0);
  for (const Triangle& t : simplified_.corners.empty() ? simplified_.triangles : simplified_.corners)
    used_[t.x] = used_[t.y] = used_[t.z] = 1;
  for (std::uint32_t w = 0; w < wedges_.size(); ++w) {
    const std::uint32_t into = simplified_.merged_into[w];
    if (images_[into] == wedges_[w]) continue;
    result.merges.push_back({wedges_[w], images_[into]});
    if (used_[into] == 0) result.bare_targets.push_back(images_[into]);
  }
  std::sort(result.bare_targets.begin(), result.bare_targets.end());
  result.bare_targets.erase(std::unique(result.bare_targets.begin(), result.bare_targets.end()),
                            result.bare_targets.end());
}

void GroupSimplifier::list_lost(SimplifiedNode& result) {
  const std::vector<std::uint8_t>& locked = group_->locked;
  used_.assign(locked.size(), 0);
  for (const Triangle& t : simplified_.triangles) used_[t.x] = used_[t.y] = used_[t.z] = 1;
  for (std::uint32_t v = 0; v < used_.size(); ++v)
    if (locked[v] != 0 && used_[v] == 0) result.lost.push_back(group_->vertices[v]);
}

// Lists the boxes of the group's triangles that are gone and stood for by no triangle that is left. Those that were
// folded onto a corner or an edge of one need no room: the boxes of its vertices hold theirs.
void GroupSimplifier::list_vanished(SimplifiedNode& result) {
  note_left();
  grown_.clear();
  for (const Triangle& own : group_->mesh.triangles) {
    const Triangle image = image_of(own);
    if (is_left(sorted(image))) continue;
    Box box = group_->boxes[own.x];
    for (int k = 1; k < 3; ++k) box = unite(box, group_->boxes[own[k]]);
    const int heir = used_[image.x] != 0 ? 0 : used_[image.y] != 0 ? 1 : 2;
    if (used_[image[heir]] != 0)
      grown_.push_back({image[heir], box});
    else
      grow(result.vanished, box);
  }
  std::sort(grown_.begin(), grown_.end(), [](const GrownBox& a, const GrownBox& b) { return a.vertex < b.vertex; });
  for (const GrownBox& grown : grown_) {
    const VertexId vertex = group_->vertices[grown.vertex];
    if (result.grown.empty() || result.grown.back().vertex != vertex)
      result.grown.push_back({vertex, grown.box});
    else
      result.grown.back().box = unite(result.grown.back().box, grown.box);
  }
}

// Notes the corners, edges and triangles that are left.
void GroupSimplifier::note_left() {
  left_.clear();
  left_edges_.clear();
  used_.assign(group_->locked.size(), 0);
  for (const Triangle& t : simplified_.triangles) {
    const auto [a, b, c] = left_.emplace_back(sorted(t));
    left_edges_.insert(left_edges_.end(), {{a, b}, {a, c}, {b, c}});
    used_[a] = used_[b] = used_[c] = 1;
  }
  std::sort(left_.begin(), left_.end());
  std::sort(left_edges_.begin(), left_edges_.end());
}

// Returns whether a triangle that is left has these corners, given in order, of which some may be equal.
bool GroupSimplifier::is_left(const std::array<std::uint32_t, 3>& corners) const {
  const auto [a, b, c] = corners;
  if (a == c) return used_[a] != 0;
  if (a == b || b == c) return std::binary_search(left_edges_.begin(), left_edges_.end(), std::pair(a, c));
  return std::binary_search(left_.begin(), left_.end(), corners);
}

// Returns the local vertex of a wedge, which simplification may have added.
VertexId GroupSimplifier::vertex_of(WedgeId wedge) const {
  const std::size_t wedges = group_->mesh.wedge_count();
  return wedge < wedges ? group_->mesh.vertex_of(wedge) : simplified_.added[wedge - wedges].vertex;
}

// Returns the local vertices into which the corners of a triangle of the input were merged.
Triangle GroupSimplifier::image_of(const Triangle& t) const {
  Triangle image;
  for (int k = 0; k < 3; ++k) image[k] = vertex_of(simplified_.merged_into[t[k]]);
  return image;
}

// Returns whether merging all triangles of the group at once leaves as many as its collapses, one after the other, did.
// Only where both sides of a sheet were folded onto other faces does the order matter.
bool GroupSimplifier::can_replay() const {
  std::vector<Triangle> merged, before, none;
  for (const Triangle& t : group_->mesh.triangles) {
    const Triangle image = image_of(t);
    if (image.x == image.y || image.y == image.z || image.z == image.x) continue;
    merged.push_back(image);
    before.push_back(t);
  }
  cancel_folded(merged, none, before);
  return merged.size() == simplified_.triangles.size();
}

void GroupSimplifier::keep_splits(SplitsDraft& within) const {
  const auto own = [](std::uint32_t local) { return static_cast<std::uint16_t>(local); };
  within.wedges = wedges_;
  for (const Triangle& t : group_->mesh.wedge_triangles())
    for (int k = 0; k < 3; ++k) within.indices.push_back(own(t[k]));
  for (const GroupCollapse& c : simplified_.collapses) within.splits.push_back({own(c.v), own(c.u), c.error});
}

}  // namespace occlod::hlod
