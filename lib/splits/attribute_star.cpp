#include "splits/attribute_star.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

namespace occlod {
namespace {

// Turning the normal by 1 radian, or changing the colour from black to white, counts as this share of the edge length.
constexpr float normal_weight = 0.25F, color_weight = 0.25F;
// For a chart without an edge to u, this many wedges of u are tried, besides a new one.
constexpr std::size_t max_candidates = 16;

template <typename T>
T interpolate(const std::vector<T>& values, const Triangle& wedges, const glm::vec3& coordinates) {
  return coordinates.x * values[wedges.x] + coordinates.y * values[wedges.y] + coordinates.z * values[wedges.z];
}

}  // namespace

void AttributeStar::gather(const StarMesh& mesh, const AttributeState& state, const PositionView& positions,
                           VertexId v) {
  state_ = &state;
  faces_.clear();
  wedges_.clear();
  next_.clear();
  last_.clear();
  areas_.clear();
  const glm::vec3 origin = positions[v];
  const Star star = mesh.star(v);
  equal_.find(star);
  for (std::size_t i = 0; i < star.size(); ++i) {
    const StarFace f = star[i];
    wedges_.push_back(state.corners.wedges(v, f, equal_.rank(i)));
    faces_.push_back(f);
    next_.push_back(positions[f.next] - origin);
    last_.push_back(positions[f.last] - origin);
    areas_.push_back(glm::length(glm::cross(next_.back(), last_.back())));
  }
  group_charts();
}

void AttributeStar::group_charts() {
  order_.resize(faces_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  std::stable_sort(order_.begin(), order_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return wedges_[a].x < wedges_[b].x; });
}

float AttributeStar::choose(VertexId u) {
  const std::size_t count = faces_.size();
  const auto at = std::find_if(faces_.begin(), faces_.end(), [&](const StarFace& f) { return contains(f, u); });
  const auto first = static_cast<std::size_t>(at - faces_.begin());
  const glm::vec3 offset = at->next == u ? next_[first] : last_[first];
  chosen_.assign(count, no_id);
  places_.resize(count);
  for (std::size_t f = 0; f < count; ++f)
    if (!contains(faces_[f], u)) places_[f] = place_in(f, offset);
  float total = 0.0F, area = 0.0F, largest = 0.0F;
  for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
    float chart_area = 0.0F;
    for (end = begin; end < count && wedges_[order_[end]].x == wedges_[order_[begin]].x; ++end)
      chart_area += areas_[order_[end]];
    const float deviation = choose_for_chart(begin, end, u, glm::dot(offset, offset));
    total += chart_area * deviation;
    area += chart_area;
    largest = std::max(largest, deviation);
  }
  // The deviation is at most 1, because the whole mesh has an extent of about 1 in this scale.
  const float mean = area > 0.0F ? total / area : largest;
  return mean < 1.0F ? mean : 1.0F;
}

AttributeStar::Place AttributeStar::place_in(std::size_t face, const glm::vec3& u) const {
  const glm::vec3 a = next_[face], b = last_[face];
  const glm::vec3 normal = glm::cross(a - u, b - u);
  const float area2 = glm::dot(normal, normal);
  if (!(area2 > 0.0F)) return {};
  const glm::vec3 c = glm::vec3(glm::dot(glm::cross(a, b), normal), glm::dot(glm::cross(b, u), normal),
                                glm::dot(glm::cross(u, a), normal)) /
                      area2;
  if (!(std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)}) < 1e6F)) return {};  // the area is nearly zero
  Place place{c, c, 0.0F, true};
  if (std::min({c.x, c.y, c.z}) >= 0.0F) return place;
  // The nearest point lies on one of the edges that face the projection.
  const glm::vec3 p = c.x * u + c.y * a + c.z * b;
  place.distance2 = std::numeric_limits<float>::infinity();
  const std::array<glm::vec3, 3> corners{u, a, b};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    const glm::vec3 edge = corners[k] - corners[i];
    const float t = std::clamp(glm::dot(p - corners[i], edge) / glm::dot(edge, edge), 0.0F, 1.0F);
    const glm::vec3 offset = p - (corners[i] + t * edge);
    if (const float distance2 = glm::dot(offset, offset); distance2 < place.distance2) {
      place.distance2 = distance2;
      place.nearest = glm::vec3(0.0F);
      place.nearest[static_cast<int>(i)] = 1.0F - t;
      place.nearest[static_cast<int>(k)] = t;
    }
  }
  return place;
}

// Returns the squared difference between v's attributes and those interpolated at `place` in the face, if u has that
// wedge.
float AttributeStar::deviation2(std::size_t face, const glm::vec3& place, WedgeId wedge_of_u, float length2) const {
  const TriangleMesh& mesh = state_->input;
  const WedgeId v = wedges_[face].x;
  const Triangle corners{wedge_of_u, wedges_[face].y, wedges_[face].z};
  float sum = 0.0F;
  if (!mesh.texture_coordinates.empty()) {
    const glm::vec2 slip = mesh.texture_coordinates[v] - interpolate(mesh.texture_coordinates, corners, place);
    sum += state_->texture_lengths[v] * state_->texture_lengths[v] * glm::dot(slip, slip);
  }
  // Normals and colours must not be extrapolated beyond the corners.
  glm::vec3 within = glm::max(place, 0.0F);
  within /= within.x + within.y + within.z;
  if (!mesh.normals.empty()) {
    const glm::vec3 normal = interpolate(mesh.normals, corners, within);
    const float length = glm::length(normal);
    const glm::vec3 turn = mesh.normals[v] - (length > 0.0F ? normal / length : normal);
    sum += normal_weight * normal_weight * length2 * glm::dot(turn, turn);
  }
  if (!mesh.colors.empty()) {
    const auto color = [&](WedgeId w) { return glm::vec4(mesh.colors[w]) / 255.0F; };
    const glm::vec4 change =
        color(v) - (within.x * color(corners.x) + within.y * color(corners.y) + within.z * color(corners.z));
    sum += color_weight * color_weight * length2 * glm::dot(change, change);
  }
  return sum;
}

// Chooses the wedge of u for the faces order_[begin, end), which form one chart. Returns the squared deviation.
float AttributeStar::choose_for_chart(std::size_t begin, std::size_t end, VertexId u, float length2) {
  candidates_.clear();
  std::size_t best_place = no_id;
  bool has_moved = false;
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t f = order_[i];
    if (contains(faces_[f], u)) {
      const WedgeId wedge = faces_[f].next == u ? wedges_[f].y : wedges_[f].z;
      if (std::find(candidates_.begin(), candidates_.end(), wedge) == candidates_.end()) candidates_.push_back(wedge);
    } else {
      has_moved = true;
      if (places_[f].is_known && (best_place == no_id || places_[f].distance2 < places_[best_place].distance2))
        best_place = f;
    }
  }
  if (!has_moved) return extent2(begin, end);
  const bool has_edge = !candidates_.empty();
  if (!has_edge) list_candidates(wedges_[order_[begin]].x, u);
  const auto cheapest = [&](std::size_t from, std::size_t to) {
    WedgeId best = candidates_.front();
    float least = std::numeric_limits<float>::infinity();
    for (const WedgeId wedge : candidates_) {
      float sum = 0.0F;
      for (std::size_t i = from; i < to; ++i)
        if (const std::uint32_t f = order_[i]; !contains(faces_[f], u) && places_[f].is_known)
          sum += areas_[f] * deviation2(f, places_[f].projected, wedge, length2);
      if (sum < least) {
        least = sum;
        best = wedge;
      }
    }
    return best;
  };
  // If u has a seam that ends at v, the two sides of the chart have different wedges.
  const bool is_split = has_edge && candidates_.size() > 1;
  const WedgeId of_all = candidates_.size() == 1 || is_split ? candidates_.front() : cheapest(begin, end);
  for (std::size_t i = begin; i < end; ++i)
    if (!contains(faces_[order_[i]], u)) chosen_[order_[i]] = is_split ? cheapest(i, i + 1) : of_all;
  if (best_place == no_id) return 0.0F;
  const float slip2 = deviation2(best_place, places_[best_place].nearest, chosen_[best_place], length2);
  return std::min(slip2, state_->extents2[wedges_[order_[begin]].x]);
}

void AttributeStar::list_merges(VertexId v, VertexId u, std::vector<WedgeMerge>& merges) const {
  for (std::size_t begin = 0, end = 0; begin < order_.size(); begin = end) {
    WedgeMerge merge{v, wedges_[order_[begin]].x, no_id, false};
    WedgeId at_edge = no_id;
    for (end = begin; end < order_.size() && wedges_[order_[end]].x == merge.wedge; ++end) {
      const std::uint32_t f = order_[end];
      if (contains(faces_[f], u)) {
        at_edge = faces_[f].next == u ? wedges_[f].y : wedges_[f].z;
      } else {
        merge.is_split = merge.is_split || (merge.into != no_id && merge.into != chosen_[f]);
        merge.into = chosen_[f];
      }
    }
    if (merge.into == no_id) merge.into = at_edge;
    merges.push_back(merge);
  }
}

// Lists wedges of u with the chart's material, and last the chart's own wedge at v, which stands for a new wedge of u.
void AttributeStar::list_candidates(WedgeId own, VertexId u) {
  state_->corners.wedges_at(u, own, max_candidates, candidates_);
  candidates_.push_back(own);
}

// Returns the mean squared distance between the faces of a chart, all of which vanish, and the edges onto which they
// collapse.
float AttributeStar::extent2(std::size_t begin, std::size_t end) const {
  float total = 0.0F, area = 0.0F;
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t f = order_[i];
    const glm::vec3 edge = next_[f] - last_[f];
    const float length2 = glm::dot(edge, edge);
    if (!(length2 > 0.0F)) continue;
    total += areas_[f] * (areas_[f] * areas_[f] / length2 / 6.0F);
    area += areas_[f];
  }
  return area > 0.0F ? total / area : 0.0F;
}

}  // namespace occlod
