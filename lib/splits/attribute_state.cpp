#include "splits/attribute_state.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <tuple>

namespace occlod {

namespace {

// O(n^2).
bool has_equal(const Star& star) {
  for (std::size_t i = 1; i < star.size(); ++i) {
    const StarFace face = star[i];
    for (std::size_t k = 0; k < i; ++k)
      if (star[k] == face) return true;
  }
  return false;
}

}  // namespace

void EqualFaces::find(const Star& star) {
  ranks_.clear();
  constexpr std::size_t few = 16;  // faces that are sooner compared with each other than sorted
  if (star.size() <= few && !has_equal(star)) return;
  sorted_.clear();
  for (std::uint32_t i = 0; i < star.size(); ++i) sorted_.emplace_back(star[i], i);
  std::sort(sorted_.begin(), sorted_.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first.next, a.first.last, a.first.made_by, a.second) <
           std::tie(b.first.next, b.first.last, b.first.made_by, b.second);
  });
  for (std::size_t i = 1; i < sorted_.size(); ++i) {
    if (sorted_[i].first != sorted_[i - 1].first) continue;
    ranks_.resize(star.size(), 0);
    ranks_[sorted_[i].second] = ranks_[sorted_[i - 1].second] + 1;
  }
}

CornerMap::CornerMap(const TriangleMesh& mesh, std::span<const MaterialId> materials)
    : materials_(materials), single_(mesh.vertex_count(), no_id), lists_(mesh.vertex_count()) {
  const std::vector<Triangle>& wedges = mesh.wedge_triangles();
  std::vector<bool> differs(mesh.vertex_count());
  const auto for_each_corner = [&](const auto& visit) {
    for (std::size_t t = 0; t < wedges.size(); ++t)
      for (int i = 0; i < 3; ++i) visit(mesh.triangles[t], wedges[t], i);
  };
  for_each_corner([&](const Triangle& face, const Triangle& corners, int i) {
    WedgeId& single = single_[face[i]];
    if (single == no_id) single = corners[i];
    if (single != corners[i]) differs[face[i]] = true;
  });
  for_each_corner([&](const Triangle& face, const Triangle& corners, int i) {
    if (differs[face[i]]) lists_[face[i]].push_back({{face[(i + 1) % 3], face[(i + 2) % 3], no_id}, corners[i]});
  });
}

WedgeId CornerMap::find(VertexId w, const StarFace& face, std::size_t rank, MaterialId of) const {
  if (lists_[w].empty()) return single_[w];
  WedgeId last = no_id;
  for (const Corner& corner : lists_[w]) {
    if (corner.face != face || material(corner.wedge) != of) continue;
    last = corner.wedge;
    if (rank-- == 0) break;
  }
  return last;
}

Triangle CornerMap::wedges(VertexId v, const StarFace& face, std::size_t rank) const {
  WedgeId at_v = single_[v];
  if (!lists_[v].empty()) {
    std::size_t alike = 0;  // equal faces of the same material before this one
    for (auto corner = lists_[v].begin(); corner != lists_[v].end(); ++corner) {
      if (corner->face != face) continue;
      at_v = corner->wedge;
      if (rank-- > 0) continue;
      for (auto other = lists_[v].begin(); other != corner; ++other)
        alike += other->face == face && material(other->wedge) == material(at_v) ? 1U : 0U;
      break;
    }
    rank = alike;
  }
  const MaterialId of = material(at_v);
  return {at_v, find(face.next, {face.last, v, face.made_by}, rank, of),
          find(face.last, {v, face.next, face.made_by}, rank, of)};
}

void CornerMap::wedges_at(VertexId v, WedgeId like, std::size_t most, std::vector<WedgeId>& out) const {
  const std::size_t first = out.size();
  const auto add = [&](WedgeId wedge) {
    const auto begin = out.begin() + static_cast<std::ptrdiff_t>(first);
    if (material(wedge) == material(like) && std::find(begin, out.end(), wedge) == out.end()) out.push_back(wedge);
  };
  if (lists_[v].empty()) return add(single_[v]);
  for (auto corner = lists_[v].begin(); corner != lists_[v].end() && out.size() < first + most; ++corner)
    add(corner->wedge);
}

void CornerMap::collapse(const StarMesh& mesh, VertexId v, VertexId u, CollapseId id, std::span<const StarFace> star,
                         std::span<const WedgeId> wedges_of_u, std::span<const LevelFace> folded) {
  bool differs = !lists_[u].empty();
  for (std::size_t i = 0; i < star.size(); ++i)
    differs = differs || (!contains(star[i], u) && wedges_of_u[i] != single_[u]);
  if (differs && lists_[u].empty()) {
    for (const StarFace f : mesh.star(u))
      if (f.made_by != id) lists_[u].push_back({f, single_[u]});
    for (const LevelFace& face : folded)  // folded faces no longer exist
      lists_[u].push_back({{face.corners.y, face.corners.z, face.made_by}, single_[u]});
  }
  for (std::size_t i = 0; i < star.size(); ++i) {
    const StarFace& f = star[i];
    if (contains(f, u)) {  // then all equal faces contain u too
      erase(f.next, {f.last, v, f.made_by}, no_id);
      erase(f.last, {v, f.next, f.made_by}, no_id);
      continue;
    }
    replace(f.next, {f.last, v, f.made_by}, {f.last, u, id});
    replace(f.last, {v, f.next, f.made_by}, {u, f.next, id});
    if (differs) lists_[u].push_back({{f.next, f.last, id}, wedges_of_u[i]});
  }
  for (const LevelFace& face : folded) {
    erase_at_corners(face.corners, face.made_by);
    erase_at_corners({u, face.corners.z, face.corners.y}, id);
  }
  std::vector<Corner>().swap(lists_[v]);
  for (const StarFace& f : star) {
    settle(f.next);
    settle(f.last);
  }
}

// Erases the first corner with that wedge, or with any wedge for no_id, if there is one.
void CornerMap::erase(VertexId w, const StarFace& face, WedgeId wedge) {
  std::vector<Corner>& list = lists_[w];
  const auto at = std::find_if(list.begin(), list.end(),
                               [&](const Corner& c) { return c.face == face && (wedge == no_id || c.wedge == wedge); });
  if (at != list.end()) list.erase(at);
}

// Erases the first of the faces that are equal to this one.
void CornerMap::erase_at_corners(const Triangle& corners, CollapseId made_by) {
  const Triangle of = wedges(corners.x, {corners.y, corners.z, made_by}, 0);
  for (int i = 0; i < 3; ++i) erase(corners[i], {corners[(i + 1) % 3], corners[(i + 2) % 3], made_by}, of[i]);
}

void CornerMap::replace(VertexId w, const StarFace& face, const StarFace& by) {
  std::vector<Corner>& list = lists_[w];
  const auto at = std::find_if(list.begin(), list.end(), [&](const Corner& c) { return c.face == face; });
  if (at != list.end()) at->face = by;
}

// Drops the list of a vertex once all its corners have one wedge.
void CornerMap::settle(VertexId w) {
  std::vector<Corner>& list = lists_[w];
  if (list.empty()) return;
  const WedgeId first = list.front().wedge;
  if (std::any_of(list.begin(), list.end(), [&](const Corner& c) { return c.wedge != first; })) return;
  single_[w] = first;
  std::vector<Corner>().swap(list);
}

namespace {

// Returns a normal whose length is twice the area.
glm::dvec3 normal_of(const TriangleMesh& mesh, const Triangle& t) {
  const glm::dvec3 a(mesh.positions[t.x]);
  return glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
}

// Relative to the sum of squared edges in texture space: a face of less area there is a line of the texture up to
// rounding, so its area is meaningless.
constexpr double min_area = 1e-4;

// Returns sqrt(area / area in texture space) over the faces at each wedge. Where texture space has no area, returns the
// value of the whole mesh.
std::vector<float> lengths_of_texture(const TriangleMesh& mesh, float scale) {
  if (mesh.texture_coordinates.empty()) return {};
  struct Areas {
    double surface = 0.0, texture = 0.0, edges2 = 0.0;
    void add(const Areas& o) { surface += o.surface, texture += o.texture, edges2 += o.edges2; }
    [[nodiscard]] bool usable() const { return surface > 0.0 && texture > min_area * edges2; }
    [[nodiscard]] float length() const { return static_cast<float>(std::sqrt(surface / texture)); }
  };
  std::vector<Areas> at(mesh.wedge_count());
  Areas all;
  for (const Triangle& t : mesh.wedge_triangles()) {
    const glm::dvec2 o(mesh.texture_coordinates[t.x]);
    const glm::dvec2 p = glm::dvec2(mesh.texture_coordinates[t.y]) - o,
                     q = glm::dvec2(mesh.texture_coordinates[t.z]) - o;
    const Areas areas{glm::length(normal_of(mesh, t)) * scale * scale, std::abs(p.x * q.y - p.y * q.x),
                      glm::dot(p, p) + glm::dot(q, q)};
    for (int i = 0; i < 3; ++i) at[t[i]].add(areas);
    all.add(areas);
  }
  const float usual = all.usable() ? all.length() : 0.0F;
  std::vector<float> lengths(at.size());
  for (std::size_t w = 0; w < at.size(); ++w) lengths[w] = at[w].usable() ? at[w].length() : usual;
  return lengths;
}

// Returns, for each wedge, roughly the mean squared width of its chart. Faces that share wedges form one chart.
std::vector<float> chart_extents2(const TriangleMesh& mesh, float scale) {
  std::vector<WedgeId> chart(mesh.wedge_count());
  std::iota(chart.begin(), chart.end(), WedgeId{0});
  const auto root = [&](WedgeId w) {
    while (chart[w] != w) w = chart[w] = chart[chart[w]];
    return w;
  };
  for (const Triangle& t : mesh.wedge_triangles()) {
    chart[root(t.y)] = root(t.x);
    chart[root(t.z)] = root(t.x);
  }
  std::vector<double> sums(chart.size(), 0.0);
  for (const Triangle& t : mesh.wedge_triangles())
    sums[root(t.x)] += 0.5 * glm::length(normal_of(mesh, t)) * scale * scale;
  std::vector<float> extents2(chart.size());
  for (WedgeId w = 0; w < chart.size(); ++w) extents2[w] = static_cast<float>(sums[root(w)] / 6.0);
  return extents2;
}

}  // namespace

std::vector<MaterialId> wedge_materials(const TriangleMesh& mesh) {
  if (mesh.triangle_materials.empty()) return {};
  std::vector<MaterialId> materials(mesh.wedge_count(), 0);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (int i = 0; i < 3; ++i) materials[mesh.wedge_triangles()[t][i]] = mesh.triangle_materials[t];
  return materials;
}

AttributeState::AttributeState(const TriangleMesh& mesh, float scale)
    : input(mesh),
      materials(wedge_materials(mesh)),
      texture_lengths(lengths_of_texture(mesh, scale)),
      extents2(chart_extents2(mesh, scale)),
      corners(mesh, materials),
      sums(mesh.vertex_count(), 0.0F) {}

namespace {

// Turning the normal by 1 radian, or changing the colour from black to white, counts as this share of the edge length.
constexpr float normal_weight = 0.25F, color_weight = 0.25F;
// For a chart without an edge to u, this many wedges of u are tried, besides a new one.
constexpr std::size_t max_candidates = 16;

template <typename T>
T interpolate(const std::vector<T>& values, const Triangle& wedges, const glm::vec3& coordinates) {
  return coordinates.x * values[wedges.x] + coordinates.y * values[wedges.y] + coordinates.z * values[wedges.z];
}

// Returns colour and alpha in [0, 1].
glm::vec4 color_of(const TriangleMesh& mesh, WedgeId wedge) {
  static constexpr std::array<float, 256> shares = [] {
    std::array<float, 256> result{};
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = static_cast<float>(i) / 255.0F;
    return result;
  }();
  const glm::u8vec4& c = mesh.colors[wedge];
  return {shares[c.r], shares[c.g], shares[c.b], shares[c.a]};
}

glm::vec4 color_in(const TriangleMesh& mesh, const Triangle& wedges, const glm::vec3& coordinates) {
  return coordinates.x * color_of(mesh, wedges.x) + coordinates.y * color_of(mesh, wedges.y) +
         coordinates.z * color_of(mesh, wedges.z);
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
  kept_.u = no_id;
}

void AttributeStar::group_charts() {
  order_.resize(faces_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  const auto before = [&](std::uint32_t a, std::uint32_t b) { return wedges_[a].x < wedges_[b].x; };
  if (!std::is_sorted(order_.begin(), order_.end(), before)) std::stable_sort(order_.begin(), order_.end(), before);
  area_ = 0.0F;
  for (std::size_t begin = 0; begin < order_.size();) {
    const auto [end, area] = chart_from(begin);
    area_ += area;
    begin = end;
  }
}

// Returns where the chart that begins there ends, and twice its area.
std::pair<std::size_t, float> AttributeStar::chart_from(std::size_t begin) const {
  float area = 0.0F;
  std::size_t end = begin;
  for (; end < order_.size() && wedges_[order_[end]].x == wedges_[order_[begin]].x; ++end) area += areas_[order_[end]];
  return {end, area};
}

void AttributeStar::keep(VertexId u, float deviation2) {
  kept_.u = u;
  kept_.deviation2 = deviation2;
  kept_.wedges.swap(chosen_);
}

float AttributeStar::settle(VertexId u) {
  if (kept_.u != u) return choose(u);
  chosen_.swap(kept_.wedges);
  kept_.u = no_id;
  return kept_.deviation2;
}

float AttributeStar::choose(VertexId u, float most) {
  const std::size_t count = faces_.size();
  const auto at = std::find_if(faces_.begin(), faces_.end(), [&](const StarFace& f) { return contains(f, u); });
  const auto first = static_cast<std::size_t>(at - faces_.begin());
  const glm::vec3 offset = at->next == u ? next_[first] : last_[first];
  chosen_.assign(count, no_id);
  places_.resize(count);
  for (std::size_t f = 0; f < count; ++f)
    if (!contains(faces_[f], u)) places_[f] = place_in({offset, next_[f], last_[f]});
  // Charts only add to the total, so one that is too much now stays so, whatever rounding does: hence the margins.
  constexpr float infinity = std::numeric_limits<float>::infinity(), margin = 1.0F + 1e-5F;
  const float most_total = most < 1.0F && area_ > 0.0F ? margin * most * area_ : infinity;
  float total = 0.0F, largest = 0.0F;
  for (std::size_t begin = 0; begin < count;) {
    const auto [end, chart_area] = chart_from(begin);
    const float most_here = chart_area > 0.0F ? margin * (most_total - total) / chart_area : infinity;
    const float deviation = choose_for_chart(begin, end, u, offset, most_here);
    total += chart_area * deviation;
    if (total > most_total) return infinity;
    largest = std::max(largest, deviation);
    begin = end;
  }
  // The deviation is at most 1, because the whole mesh has an extent of about 1 in this scale.
  const float mean = area_ > 0.0F ? total / area_ : largest;
  return mean < 1.0F ? mean : 1.0F;
}

// Returns where the origin lies in a triangle.
AttributeStar::Place AttributeStar::place_in(const std::array<glm::vec3, 3>& corners) {
  const auto& [u, a, b] = corners;
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
    const glm::vec4 change = color_of(mesh, v) - color_in(mesh, corners, within);
    sum += color_weight * color_weight * length2 * glm::dot(change, change);
  }
  return sum;
}

// Returns the largest squared change of colour in the middle of an old edge between v and a corner of the chart, where
// new edges may cross it. A line between two colours that bends at v may straighten without any change at v itself.
// Returns early with what is more than `most`.
float AttributeStar::color_change_at_edges2(std::size_t begin, std::size_t end, VertexId u, const glm::vec3& offset,
                                            float most) const {
  const TriangleMesh& mesh = state_->input;
  float largest = 0.0F;
  for (std::size_t i = begin; i < end && !(largest > most); ++i) {
    const std::uint32_t edge = order_[i];
    const glm::vec3 middle = 0.5F * next_[edge];
    Place nearest;
    nearest.distance2 = std::numeric_limits<float>::infinity();
    std::uint32_t face = no_id;
    for (std::size_t k = begin; k < end && nearest.distance2 > 0.0F; ++k) {
      const std::uint32_t f = order_[k];
      if (contains(faces_[f], u)) continue;
      const Place place = place_in({offset - middle, next_[f] - middle, last_[f] - middle});
      if (!place.is_known || !(place.distance2 < nearest.distance2)) continue;
      nearest = place;
      face = f;
    }
    if (face == no_id) continue;
    const glm::vec4 old = 0.5F * (color_of(mesh, wedges_[edge].x) + color_of(mesh, wedges_[edge].y));
    const glm::vec4 change = old - color_in(mesh, {chosen_[face], wedges_[face].y, wedges_[face].z}, nearest.nearest);
    largest = std::max(largest, glm::dot(change, change));
  }
  return largest;
}

// Chooses the wedge of u for the faces order_[begin, end), which form one chart. Returns the squared deviation, or,
// early, less of it that is more than `most`.
float AttributeStar::choose_for_chart(std::size_t begin, std::size_t end, VertexId u, const glm::vec3& offset,
                                      float most) {
  const float length2 = glm::dot(offset, offset);
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
  float slip2 = deviation2(best_place, places_[best_place].nearest, chosen_[best_place], length2);
  const float extent = state_->extents2[wedges_[order_[begin]].x];
  if (!state_->input.colors.empty() && !(std::min(slip2, extent) > most)) {
    const float per_change = color_weight * color_weight * length2;
    const float most_change = extent > most && per_change > 0.0F ? (1.0F + 1e-5F) * most / per_change
                                                                 : std::numeric_limits<float>::infinity();
    slip2 = std::max(slip2, per_change * color_change_at_edges2(begin, end, u, offset, most_change));
  }
  return std::min(slip2, extent);
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
