// What refinement reads for every split it looks at: one cache line.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "occlod/core/ids.h"
#include "occlod/math/bounds.h"

namespace occlod {

// Cone, cylinder and box of a subtree, relative to its sphere, in steps of 1/65535 of their ranges. Packing rounds
// outwards: what unpacks holds what was packed.
struct PackedBounds {
  std::array<std::uint16_t, 2> axis{};        // octahedral; of the cone and of the cylinder
  std::uint16_t cone_cos = 0;                 // [0, 1]; 0 = no cone
  std::uint16_t cylinder_radius = 0;          // [0, radius of the sphere]
  std::array<std::uint16_t, 2> cylinder_t{};  // [-radius, radius]: t_min, t_max
  std::array<std::uint16_t, 3> box_min{};     // [center - radius, center + radius]
  std::array<std::uint16_t, 3> box_max{};

  void set_axis(const glm::vec3& direction);  // unit length; the others are packed against what axis unpacks to
  [[nodiscard]] glm::vec3 unpack_axis() const noexcept;
  void set_cone(float cos_angle);
  // The cylinder around `sphere.center` and unpack_axis(), inside the sphere.
  void set_cylinder(const Sphere& sphere, const Cylinder& cylinder);
  // Inside the sphere.
  void set_box(const Sphere& sphere, const Box& box);

  [[nodiscard]] NormalCone cone() const noexcept;
  [[nodiscard]] Cylinder cylinder(const Sphere& sphere) const noexcept;
  [[nodiscard]] Box box(const Sphere& sphere) const noexcept;
};

// Split s brings back vertex base_vertex_count + s. Its bounds are around every face that it or a split below it in the
// forest removes or inserts. Lengths are object units.
struct SplitNode {
  Sphere sphere;
  float error = 0.0F;  // quadric error: root mean square distance, ordered collapses; >= that of every split that
                       // depends on this one or stands below it in the forest
  float guaranteed_error =
      0.0F;  // bound on the distance between the surface without this split and the input; saturated alike
  SplitId child_u = no_id;  // forest: the next split of the same parent vertex
  SplitId child_v = no_id;  // forest: the first split of the vertex that this one brings back
  SplitId parent = no_id;   // forest; none at roots
  std::uint32_t star = 0;   // where its SplitStar starts; that of the next node is where it ends
  PackedBounds bounds;

  [[nodiscard]] NormalCone cone() const noexcept { return bounds.cone(); }
  [[nodiscard]] Cylinder cylinder() const noexcept { return bounds.cylinder(sphere); }
  [[nodiscard]] Box box() const noexcept { return bounds.box(sphere); }
};
static_assert(sizeof(SplitNode) == 64, "one cache line");

}  // namespace occlod
