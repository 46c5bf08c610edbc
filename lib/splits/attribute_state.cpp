#include "splits/attribute_state.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>

namespace occlod {

void EqualFaces::find(const Star& star) {
  ranks_.clear();
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

}  // namespace occlod
