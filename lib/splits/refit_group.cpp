#include "splits/refit_group.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numeric>
#include <vector>

#include "splits/positions.h"
#include "splits/quadric_minima.h"
#include "splits/refit.h"

namespace occlod {
namespace {

constexpr float least_step = 1.0F / 64.0F;  // of the group's error: smaller moves are not worth a position of their own
// Of the largest error of a collapse into a vertex: without a limit, few vertices go far astray, where faces that are
// not near them are taken for theirs.
constexpr float farthest_step = 4.0F;

// Returns the vertices into which those of the group were merged.
std::vector<VertexId> targets_of(std::size_t vertex_count, std::span<Collapse* const> collapses) {
  std::vector<VertexId> target(vertex_count);
  std::iota(target.begin(), target.end(), 0U);
  for (std::size_t i = collapses.size(); i-- > 0;) target[collapses[i]->v] = target[collapses[i]->u];
  return target;
}

std::vector<VertexId> vertices_of(std::span<const Triangle> faces, std::size_t vertex_count) {
  std::vector<std::uint8_t> is_used(vertex_count, 0);
  for (const Triangle& t : faces) is_used[t.x] = is_used[t.y] = is_used[t.z] = 1;
  std::vector<VertexId> result;
  for (VertexId v = 0; v < vertex_count; ++v)
    if (is_used[v] != 0) result.push_back(v);
  return result;
}

// Returns how far each vertex may move, object units.
std::vector<float> farthest_moves(const GroupCollapses& group, std::span<const VertexId> target) {
  std::vector<float> result(target.size(), 0.0F);
  for (const Collapse* const collapse : group.collapses) {
    float& most = result[target[collapse->v]];
    most = std::max(most, farthest_step * collapse->error);
  }
  return result;
}

std::vector<std::uint8_t> held(const GroupCollapses& group, const SimplifiedGroup& result, bool along_normals) {
  const std::size_t vertices = group.mesh.vertex_count();
  std::vector<std::uint8_t> held(vertices, 0);
  if (!along_normals && !result.corners.empty()) held = on_seams(result.triangles, result.corners, vertices);
  for (const std::span<const std::uint8_t> stay : {group.locked, group.target.held})
    for (std::size_t v = 0; v < stay.size(); ++v) held[v] |= stay[v];
  return held;
}

// How the root mean square distance of a vertex from the planes of its faces changes when it moves.
struct ErrorChange {
  float nearer = 1.0F;   // it is multiplied by this
  float farther = 0.0F;  // and the square of this added to its own, object units

  [[nodiscard]] float of(float error) const {
    if (farther == 0.0F) return nearer * error;
    const double a = error, b = farther;
    return static_cast<float>(std::sqrt(a * a + b * b));
  }
};

ErrorChange change_of(const VertexQuadric& quadric, float scale, const glm::vec3& step) {
  const float before = quadric.mean_square(glm::vec3(0.0F)), after = quadric.mean_square(scale * step);
  if (after < before) return {.nearer = std::sqrt(after / before)};
  return {.farther = std::sqrt(after - before) / scale};
}

}  // namespace

void refit_group(const GroupCollapses& group, SimplifyState& state, SimplifiedGroup& result) {
  const std::size_t vertices = group.mesh.vertex_count();
  const std::vector<VertexId> target = targets_of(vertices, group.collapses);
  const std::vector<VertexId> left = vertices_of(result.triangles, vertices);
  const std::vector<glm::vec3> minima = quadric_minima(state, left, target, group.mesh.triangles);
  const auto positions = std::span(group.mesh.positions).first(vertices);
  const bool along_normals = !group.mesh.texture_coordinates.empty();
  const std::vector<std::uint8_t> stay = held(group, result, along_normals);
  const std::vector<float> most = farthest_moves(group, target);
  const RefitRules rules{.held = stay,
                         .along_normals = along_normals,
                         .lattice_step = group.target.lattice_step,
                         .least_step = least_step * result.error,
                         .most = most,
                         .keeps_apart = true};
  std::vector<glm::vec3> moved =
      refit({positions, group.mesh.triangles, target, result.triangles, minima, state.scale}, rules, 1);
  if (std::ranges::equal(moved, positions)) return;

  std::vector<float> steps(vertices, 0.0F);
  float farthest = 0.0F;
  std::vector<ErrorChange> changes(vertices);
  for (const VertexId v : left) {
    if (moved[v] == positions[v]) continue;
    const glm::vec3 step = moved[v] - positions[v];
    steps[v] = scaled_up(static_cast<float>(glm::length(glm::dvec3(step))), 1.0F + 1e-6F);
    farthest = std::max(farthest, steps[v]);
    changes[v] = change_of(state.vertices[v].quadric, state.scale, step);
  }
  result.error = group.torn;
  for (std::size_t i = 0; i < group.collapses.size(); ++i) {
    const ErrorChange& change = changes[target[group.collapses[i]->v]];
    result.error = std::max(result.error, change.of(group.collapses[i]->error));
    if (!group.attribute_errors.empty()) result.error = std::max(result.error, group.attribute_errors[i]);
  }
  for (std::size_t i = 0; i < result.bounds.size(); ++i) {
    const Triangle& t = result.triangles[i];
    result.bounds[i] = scaled_up(result.bounds[i] + std::max({steps[t.x], steps[t.y], steps[t.z]}), 1.0F + 1e-6F);
  }
  // The bound holds for the way back too, from every point of the group, which no face's own bound tells of.
  result.guaranteed_error = scaled_up(result.guaranteed_error + farthest, 1.0F + 1e-6F);
  result.positions = std::move(moved);
}

}  // namespace occlod
