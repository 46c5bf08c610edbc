#include "simplify_state.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "parallel.h"
#include "unit_scale.h"

namespace occlod {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

}  // namespace

SimplifyState::SimplifyState(const TriangleMesh& input, const SimplifySetup& setup, const ProgressPart& progress)
    : scale(setup.scale > 0.0F ? setup.scale : power_of_two_scale(input.positions)),
      locked(setup.locked),
      vertices(input.vertex_count()),
      mesh(input.triangles, input.vertex_count(), setup.threads),
      turns(input.vertex_count()),
      attribute_weight2(static_cast<float>(setup.attribute_weight * setup.attribute_weight)) {
  if (setup.keeps_attributes && has_wedge_attributes(input))
    attributes = std::make_unique<AttributeState>(input, scale);
  for_each_id(vertices.size(), setup.threads, [&](VertexId v) {
    vertices[v] = {input.positions[v] * scale, infinity, 0.0F, {}};
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

// And proposes. What is never merged needs neither.
void SimplifyState::make_quadric(VertexId v, Fan& fan, double boundary_weight) {
  if (is_locked(v)) return;
  if (fan.gather(mesh, v)) {
    fan.measure_offsets(position_of());
    fan.measure_normals();
    vertices[v].quadric = fan.quadric();
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
  vertices[v].cost = propose(v, fan);
}

// Planes through the feature edges at v, upright on their faces: leaving the line costs.
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
