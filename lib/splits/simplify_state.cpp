#include "splits/simplify_state.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <vector>

#include "base/threads.h"
#include "splits/positions.h"

namespace occlod {
namespace {

// Weight of the planes that hold seams, relative to those of a boundary; and the mean squared width, in squared edges,
// from which a chart's seams are held with full weight. See docs/internals/decisions.md#37-wedges-beside-positions.
constexpr float seam_weight = 0.3F, min_held = 4.0F / 3.0F;
constexpr float infinity = std::numeric_limits<float>::infinity();

}  // namespace

SimplifyState::SimplifyState(const TriangleMesh& input, const SimplifySetup& setup, const ProgressPart& progress)
    : scale(setup.scale > 0.0F ? setup.scale : power_of_two_scale(input.positions)),
      locked(setup.locked),
      vertices(input.vertex_count()),
      mesh(input.triangles, input.vertex_count(), setup.threads),
      records(input.vertex_count()),
      attribute_weight2(static_cast<float>(setup.attribute_weight * setup.attribute_weight)),
      keeps_wedge_merges(setup.keeps_wedge_merges),
      keeps_collapses(setup.keeps_collapses) {
  if (setup.keeps_attributes && has_wedge_attributes(input))
    attributes = std::make_unique<AttributeState>(input, scale);
  for_each_id(vertices.size(), setup.threads, [&](VertexId v) {
    vertices[v] = {input.positions[v] * scale, infinity, v, {}};
  });
  const ProgressPart part{progress.progress, progress.first, progress.last, static_cast<double>(vertices.size())};
  for_each_range(
      vertices.size(), setup.threads,
      [&](std::size_t begin, std::size_t end) {
        Fan fan;
        for (auto v = static_cast<VertexId>(begin); v < end; ++v) make_quadric(v, fan, setup.boundary_weight);
      },
      [&](std::size_t done) { part.reach(done); });
}

// Makes the quadric and proposes a collapse. A vertex that is never merged needs neither.
void SimplifyState::make_quadric(VertexId v, Fan& fan, double boundary_weight) {
  if (is_locked(v)) return;
  if (fan.gather(mesh, v)) {
    fan.measure_offsets(position_of());
    fan.measure_normals();
    vertices[v].quadric = fan.quadric();
    if (attributes != nullptr && attributes->corners.is_on_seam(v)) hold_seams(v);
    const auto fan_costs = fan.costs(vertices[v].quadric);
    vertices[v].cost = *std::min_element(fan_costs.begin(), fan_costs.end());
    return;
  }
  for (const StarFace f : mesh.star(v)) {
    const glm::vec3 normal = glm::cross(edge(v, f.next), edge(v, f.last));
    const float twice_area = glm::length(normal);
    if (!(twice_area > 0.0F)) continue;
    vertices[v].quadric.add_plane(normal / twice_area, twice_area);
    vertices[v].quadric.weight += twice_area;
  }
  if (!mesh.star(v).is_ring()) hold_edges(v, boundary_weight);
  if (attributes != nullptr && attributes->corners.is_on_seam(v)) hold_seams(v);
  vertices[v].cost = propose(v, fan);
}

// Adds planes through the feature edges at v, perpendicular to their faces, so that leaving the feature line costs.
void SimplifyState::hold_edges(VertexId v, double boundary_weight) {
  for (const StarFace f : mesh.star(v)) {
    const glm::vec3 to_next = edge(v, f.next), to_last = edge(v, f.last);
    const glm::vec3 face_normal = glm::cross(to_next, to_last);
    for (const auto& [w, along] : {std::pair(f.next, to_next), std::pair(f.last, to_last)}) {
      if (mesh.edge_degree(v, w) == 2) continue;
      const glm::vec3 across = glm::cross(along, face_normal);
      const float length = glm::length(across);
      if (length > 0.0F)
        vertices[v].quadric.add_plane(across / length, static_cast<float>(boundary_weight) * glm::dot(along, along));
    }
  }
}

// Adds planes through the seams at v, perpendicular to their faces, so that a chart keeps its outline. Charts of a few
// faces get less weight.
void SimplifyState::hold_seams(VertexId v) {
  struct Side {
    VertexId w;
    WedgeId of_v, of_w;
    glm::vec3 across;
  };
  std::vector<Side> sides;
  const Star star = mesh.star(v);
  EqualFaces equal;
  equal.find(star);
  for (std::size_t i = 0; i < star.size(); ++i) {
    const StarFace f = star[i];
    const Triangle wedges = attributes->corners.wedges(v, f, equal.rank(i));
    const glm::vec3 to_next = edge(v, f.next), to_last = edge(v, f.last);
    const glm::vec3 normal = glm::cross(to_next, to_last);
    sides.push_back({f.next, wedges.x, wedges.y, glm::cross(to_next, normal)});
    sides.push_back({f.last, wedges.x, wedges.z, glm::cross(to_last, normal)});
  }
  // Sorts the sides by their neighbours, to find those whose wedges differ.
  std::vector<std::uint32_t> order(sides.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return sides[a].w < sides[b].w; });
  std::vector<bool> is_seam(sides.size());
  for (auto begin = order.begin(), end = begin; begin != order.end(); begin = end) {
    const Side& first = sides[*begin];
    end = std::find_if(begin, order.end(), [&](std::uint32_t i) { return sides[i].w != first.w; });
    const bool differ = std::any_of(
        begin, end, [&](std::uint32_t i) { return sides[i].of_v != first.of_v || sides[i].of_w != first.of_w; });
    for (auto i = begin; i != end; ++i) is_seam[*i] = differ;
  }
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Side& side = sides[i];
    const float length = glm::length(side.across);
    if (!is_seam[i] || !(length > 0.0F)) continue;
    const glm::vec3 along = edge(v, side.w);
    const float length2 = glm::dot(along, along);
    const float share = std::min(1.0F, attributes->extents2[side.of_v] / (min_held * length2));
    vertices[v].quadric.add_plane(side.across / length, seam_weight * attribute_weight2 * share * share * length2);
  }
}

void SimplifyState::add_plane_of(const Triangle& face, VertexId v) {
  const glm::vec3 normal = glm::cross(edge(face.x, face.y), edge(face.x, face.z));
  const float twice_area = glm::length(normal);
  if (!(twice_area > 0.0F)) return;
  VertexQuadric quadric;
  quadric.add_plane(normal / twice_area, twice_area);
  quadric.weight = twice_area;
  vertices[v].quadric.add(quadric, edge(face.x, v));
}

float SimplifyState::propose(VertexId v, Fan& fan) const {
  float cheapest = infinity;
  if (fan.gather(mesh, v)) {
    fan.measure_offsets(position_of());
    const auto fan_costs = fan.costs(vertices[v].quadric);
    cheapest = *std::min_element(fan_costs.begin(), fan_costs.end());
  } else {
    for (const StarFace f : mesh.star(v)) cheapest = std::min({cheapest, cost(v, f.next), cost(v, f.last)});
  }
  return cheapest;
}

}  // namespace occlod
