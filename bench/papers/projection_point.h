// Where shrunk occluders are drawn from: Chhugani and others 2003, sec. 5.2.1.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "papers/convex_occluder.h"

namespace occlod::paper {

// f(x) = 1/2 x.Hx + c.x, strictly convex.
struct Quadratic {
  glm::dmat3 h{0.0};  // symmetric, positive definite
  glm::dvec3 c{0.0};
};

// The point inside all half-spaces where f is least; none where there is no such point. `slack`: by how much a
// half-space may be missed. One half-space after the other, in an order that is random and always the same: where one
// is missed, the point lies on its plane (Seidel 1991; Matousek, Sharir and Welzl 1996). Expected O(n).
[[nodiscard]] std::optional<glm::dvec3> minimise(const Quadratic& f, std::span<const HalfSpace> spaces, double slack);

// What the projection point is to be good for.
struct ShrinkGoal {
  glm::dvec3 normal{0.0};   // of the plane that stands for the occluder, towards the cell
  double offset = 0.0;      // D_1: where it is
  double far_offset = 0.0;  // D_2: the last parallel plane that meets the scene
  double spread = 0.0;      // alpha: the area that the shrunk frustum has at the distance 1 from its apex
  glm::dvec3 best{0.0};     // O: the point that is best for this occluder alone, farthest from it
};
// Of one occluder and its frustum; none where the frustum is no cone that goes on for ever. O(planes^4).
[[nodiscard]] std::optional<ShrinkGoal> shrink_goal(const ShadowFrustum& frustum, const CellBox& cell,
                                                    const CellBox& scene);

// Inside all `spaces`, the least sum of alpha (D_1 - D_2) (N.v - N.O)^2, which stands for the largest volume of all
// shrunk frusta; the middle of the cell, which is always inside, without goals.
[[nodiscard]] glm::dvec3 projection_point(std::span<const ShrinkGoal> goals, std::span<const HalfSpace> spaces,
                                          const CellBox& cell);

}  // namespace occlod::paper
