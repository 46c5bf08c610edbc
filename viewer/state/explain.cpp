#include "explain.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "raster/screen_bounds.h"
#include "refine/star_visibility.h"

namespace occlod::viewer {
namespace {

// Finds the splits that would come next at the vertices of a cut.
class NextSplits {
 public:
  NextSplits(const Hierarchy& hierarchy, std::span<const SplitId> applied) : hierarchy_(hierarchy) {
    applied_.resize(hierarchy.split_count());
    for (const SplitId s : applied) applied_[s] = true;
    base_roots_.assign(hierarchy.base_vertex_count(), no_id);
    for (const SplitId root : hierarchy.data().roots) {
      const VertexId u = hierarchy.parent_vertex(root);
      if (u < base_roots_.size()) base_roots_[u] = root;
    }
  }

  // Returns the first unapplied split in the chain of the corner's vertex, or no_id.
  [[nodiscard]] SplitId of(WedgeId corner) {
    const VertexId v = hierarchy_.vertex_of_wedge(corner);
    const auto known = known_.find(v);
    if (known != known_.end()) return known->second;
    SplitId s =
        v < base_roots_.size() ? base_roots_[v] : hierarchy_.node(static_cast<SplitId>(v - base_roots_.size())).child_v;
    while (s != no_id && applied_[s]) s = hierarchy_.node(s).child_u;
    known_.emplace(v, s);
    return s;
  }

 private:
  const Hierarchy& hierarchy_;
  std::vector<bool> applied_;
  std::vector<SplitId> base_roots_;
  std::unordered_map<VertexId, SplitId> known_;
};

bool faces_eye(const Triangle& t, std::span<const glm::vec3> positions, const glm::vec3& eye) {
  const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
  return glm::dot(glm::cross(b - a, c - a), eye - a) > 0.0F;
}

bool outside_a_plane(const Triangle& t, std::span<const glm::vec3> positions, const ObjectView& view) {
  return std::any_of(view.planes().begin(), view.planes().end(), [&](const glm::vec4& plane) {
    const auto outside = [&](VertexId v) { return glm::dot(glm::vec3(plane), positions[v]) + plane.w < 0.0F; };
    return outside(t.x) && outside(t.y) && outside(t.z);
  });
}

// Judges splits like refinement does, each once.
class Judge {
 public:
  Judge(const PlacedObject& object, const View& view, const DepthPyramid* occluder)
      : hierarchy_(*object.mesh->hierarchy),
        two_sided_(object.two_sided),
        view_(view),
        object_view_(view, object.object_to_world),
        occluder_(occluder) {}

  [[nodiscard]] bool star_is_seen(SplitId s) {
    const auto [known, is_new] = seen_.try_emplace(s, false);
    if (is_new) known->second = star_.evaluate(hierarchy_, s, object_view_, two_sided_).visible_share > 0.0F;
    return known->second;
  }

  [[nodiscard]] Outcome next(SplitId s) {
    const auto [known, is_new] = outcomes_.try_emplace(s, Outcome::budget);
    if (is_new) known->second = judge(s);
    return known->second;
  }

 private:
  [[nodiscard]] Outcome judge(SplitId s) {
    const SplitNode& node = hierarchy_.node(s);
    if (!object_view_.may_be_inside(node.sphere)) return Outcome::off_screen;
    if (!two_sided_ && faces_away(node.cone(), node.sphere, object_view_.eye())) return Outcome::back_facing;
    const StarView star = star_.evaluate(hierarchy_, s, object_view_, two_sided_);
    if (star.visible_share == 0.0F)
      return object_view_.may_be_inside(star.sphere) ? Outcome::back_facing : Outcome::off_screen;
    return is_hidden(s) ? Outcome::hidden : Outcome::budget;
  }

  [[nodiscard]] bool is_hidden(SplitId s) {
    if (occluder_ == nullptr) return false;
    const VisibilityQuery query{0, PointHull{star_.points(hierarchy_, s)}};
    const auto bounds = screen_bounds(view_, object_view_, query);
    return bounds && !bounds->rect.empty() && !occluder_->any_visible(bounds->rect, bounds->largest_nearness);
  }

  const Hierarchy& hierarchy_;
  bool two_sided_;
  const View& view_;
  ObjectView object_view_;
  const DepthPyramid* occluder_;
  StarVisibility star_;
  std::unordered_map<SplitId, bool> seen_;
  std::unordered_map<SplitId, Outcome> outcomes_;
};

// At a triangle with several next splits, the one that refinement would prefer decides.
constexpr std::array<Outcome, outcome_count> by_weight = {Outcome::forced,      Outcome::budget,     Outcome::hidden,
                                                          Outcome::back_facing, Outcome::off_screen, Outcome::complete};

Outcome weightier(Outcome a, Outcome b) {
  const auto* const place_a = std::find(by_weight.begin(), by_weight.end(), a);
  const auto* const place_b = std::find(by_weight.begin(), by_weight.end(), b);
  return place_a < place_b ? a : b;
}

}  // namespace

// A split inserts the star of its vertex, whose other vertices existed before. So the last vertex of a triangle gives
// its split.
std::vector<SplitId> born_splits(const Hierarchy& hierarchy, std::span<const Triangle> triangles) {
  std::vector<SplitId> born;
  born.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const VertexId last =
        std::max({hierarchy.vertex_of_wedge(t.x), hierarchy.vertex_of_wedge(t.y), hierarchy.vertex_of_wedge(t.z)});
    const auto base = static_cast<VertexId>(hierarchy.base_vertex_count());
    born.push_back(last < base ? no_id : static_cast<SplitId>(last - base));
  }
  return born;
}

std::vector<Seen> classify(const PlacedObject& object, std::span<const Triangle> triangles, const View& view,
                           const std::vector<bool>& owns_pixel, std::size_t first_item) {
  const std::span<const glm::vec3> positions = object.mesh->hierarchy->positions();
  const ObjectView object_view(view, object.object_to_world);
  std::vector<Seen> seen;
  seen.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (owns_pixel[first_item + i])
      seen.push_back(Seen::visible);
    else if (outside_a_plane(triangles[i], positions, object_view))
      seen.push_back(Seen::off_screen);
    else if (!object.two_sided && !faces_eye(triangles[i], positions, object_view.eye()))
      seen.push_back(Seen::back_facing);
    else
      seen.push_back(Seen::hidden);
  }
  return seen;
}

std::vector<Outcome> outcomes(const PlacedObject& object, const RefinedObject& refined, const View& view,
                              const DepthPyramid* occluder) {
  const Hierarchy& hierarchy = *object.mesh->hierarchy;
  NextSplits next_splits(hierarchy, refined.splits);
  Judge judge(object, view, occluder);
  const std::vector<SplitId> born = born_splits(hierarchy, refined.triangles);
  std::vector<Outcome> result(refined.triangles.size(), Outcome::complete);
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (born[i] != no_id && !judge.star_is_seen(born[i])) {
      result[i] = Outcome::forced;
      continue;
    }
    for (int k = 0; k < 3; ++k)
      if (const SplitId next = next_splits.of(refined.triangles[i][k]); next != no_id)
        result[i] = weightier(result[i], judge.next(next));
  }
  return result;
}

std::vector<double> errors_px(const PlacedObject& object, const RefinedObject& refined, const View& view,
                              ErrorOf what) {
  const Hierarchy& hierarchy = *object.mesh->hierarchy;
  NextSplits next_splits(hierarchy, refined.splits);
  const ObjectView object_view(view, object.object_to_world);
  std::vector<double> errors;
  errors.reserve(refined.triangles.size());
  for (const Triangle& t : refined.triangles) {
    float error = 0.0F;
    for (int k = 0; k < 3; ++k)
      if (const SplitId next = next_splits.of(t[k]); next != no_id)
        error = std::max(error, what == ErrorOf::shape ? hierarchy.node(next).error : hierarchy.attribute_error(next));
    // The scale is that at the triangle: that of a whole subtree is unlimited once the eye is inside its sphere.
    const std::array<glm::vec3, 3> corners = {hierarchy.positions()[t.x], hierarchy.positions()[t.y],
                                              hierarchy.positions()[t.z]};
    const Box box = bounding_box(corners);
    const glm::vec3 center = 0.5F * (box.min + box.max);
    errors.push_back(error == 0.0F ? 0.0
                                   : static_cast<double>(error) * static_cast<double>(object_view.largest_scale_px(
                                                                      {center, glm::distance(center, box.max)})));
  }
  return errors;
}

}  // namespace occlod::viewer
