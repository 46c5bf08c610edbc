// Random views, placements and bounds, and points of those bounds: the same numbers with every standard library.
#pragma once

#include <cstdint>
#include <deque>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <random>
#include <vector>

#include "occlod/view.h"
#include "occlod/visibility.h"

namespace occlod::test {

enum class BoundKind { sphere, box, cylinder, hull };
inline constexpr int bound_kinds = 4;
[[nodiscard]] const char* label(BoundKind kind);

// The points of its hulls live as long as it does.
class RandomShapes {
 public:
  explicit RandomShapes(std::uint32_t seed) : random_(seed) {}

  double in(double low, double high);
  int below(int end);  // 0 to end - 1
  BoundKind kind() { return static_cast<BoundKind>(below(bound_kinds)); }
  glm::dvec3 point(double range);  // in [-range, range]^3
  glm::dvec3 unit();

  View view();  // one in four is orthographic
  // A rotation, a scale that differs by axis and may mirror, and another rotation: the origin stays.
  glm::dmat4 linear();
  glm::dmat4 placement();  // and a translation

  // Around or beside `center`, within about `size` of it; from flat to full.
  VisibilityQuery bound(BoundKind kind, const glm::vec3& center, double size, std::uint32_t object = 0);
  VisibilityQuery bound(BoundKind kind, double size);  // of object 0, somewhere in [-4, 4]^3
  // A point of the bound, most often on its surface.
  glm::dvec3 sample(const VisibilityQuery& bound);

 private:
  glm::dmat4 rotation();
  double shrink() { return in(0.0, 1.0) < 0.8 ? 1.0 : in(0.0, 1.0); }
  glm::dvec3 sample_of(const Sphere& sphere);
  glm::dvec3 sample_of(const Box& box);
  glm::dvec3 sample_of(const Cylinder& cylinder);
  glm::dvec3 sample_of(const PointHull& hull);

  std::mt19937 random_;
  std::deque<std::vector<glm::vec3>> hulls_;
};

// Where a point of an object is on the screen, in double from the exact matrices.
struct Projected {
  double x, y;  // pixels
  double nearness;
};

// Nothing before the near plane.
[[nodiscard]] std::optional<Projected> project(const View& view, const glm::dmat4& object_to_world,
                                               const glm::dvec3& p);

}  // namespace occlod::test
