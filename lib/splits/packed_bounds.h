// Bounds of a subtree of splits in 24 bytes.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>

#include "occlod/bounds.h"
#include "occlod/hierarchy.h"

namespace occlod {

// Cone, cylinder and box of a subtree, relative to its sphere, in steps of 1/65535 of their ranges. Packing rounds
// outwards: unpacked bounds contain what was packed.
struct PackedBounds {
  std::array<std::uint16_t, 2> axis{};        // octahedral; axis of the cone and of the cylinder
  std::uint16_t cone_cos = 0;                 // [0, 1]; 0 = no cone
  std::uint16_t cylinder_radius = 0;          // [0, radius of the sphere]
  std::array<std::uint16_t, 2> cylinder_t{};  // [-radius, radius]: t_min, t_max
  std::array<std::uint16_t, 3> box_min{};     // [center - radius, center + radius]
  std::array<std::uint16_t, 3> box_max{};     // [center - radius, center + radius]

  // Sets the axis (unit length). Call it first: cone and cylinder are packed around the axis as it unpacks.
  void set_axis(const glm::vec3& direction);
  // Returns the unpacked axis, unit length.
  [[nodiscard]] glm::vec3 unpack_axis() const noexcept;
  // Packs a cone around unpack_axis(); see NormalCone.
  void set_cone(float cos_angle);
  // Packs the cylinder around `sphere.center` and unpack_axis(); it is inside the sphere.
  void set_cylinder(const Sphere& sphere, const Cylinder& cylinder);
  // Packs a box, which is inside the box around the sphere.
  void set_box(const Sphere& sphere, const Box& box);

  // Returns a cone that contains the packed one.
  [[nodiscard]] NormalCone cone() const noexcept;
  // Returns a cylinder that contains the one packed with the same sphere.
  [[nodiscard]] Cylinder cylinder(const Sphere& sphere) const noexcept;
  // Returns a box that contains the one packed with the same sphere.
  [[nodiscard]] Box box(const Sphere& sphere) const noexcept;
};

// Returns the bounds that SplitNode::bounds holds.
[[nodiscard]] inline PackedBounds packed_bounds(const SplitNode& node) noexcept {
  return std::bit_cast<PackedBounds>(node.bounds);
}
// Puts bounds into SplitNode::bounds.
inline void set_packed_bounds(SplitNode& node, const PackedBounds& bounds) noexcept {
  node.bounds = std::bit_cast<decltype(node.bounds)>(bounds);
}

}  // namespace occlod
