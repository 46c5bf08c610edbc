// What refinement reads for every split it looks at: one cache line.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "occlod/core/ids.h"
#include "occlod/math/bounds.h"

namespace occlod {

// Cone, cylinder and box of a subtree, relative to its sphere, in steps of 1/65535 of their ranges. Packing rounds
// outwards: unpacked bounds contain what was packed.
struct PackedBounds {
  std::array<std::uint16_t, 2> axis{};        // octahedral; of the cone and of the cylinder
  std::uint16_t cone_cos = 0;                 // [0, 1]; 0 = no cone
  std::uint16_t cylinder_radius = 0;          // [0, radius of the sphere]
  std::array<std::uint16_t, 2> cylinder_t{};  // [-radius, radius]: t_min, t_max
  std::array<std::uint16_t, 3> box_min{};     // [center - radius, center + radius]
  std::array<std::uint16_t, 3> box_max{};     // likewise

  // Unit length. To be set first: cone and cylinder are packed around the axis as it unpacks.
  void set_axis(const glm::vec3& direction);
  // Unit length.
  [[nodiscard]] glm::vec3 unpack_axis() const noexcept;
  // A cone around unpack_axis(); see NormalCone.
  void set_cone(float cos_angle);
  // The cylinder around `sphere.center` and unpack_axis(), inside the sphere.
  void set_cylinder(const Sphere& sphere, const Cylinder& cylinder);
  // A box inside the box around the sphere.
  void set_box(const Sphere& sphere, const Box& box);

  // Contains what was packed.
  [[nodiscard]] NormalCone cone() const noexcept;
  // Contains what was packed with the same sphere.
  [[nodiscard]] Cylinder cylinder(const Sphere& sphere) const noexcept;
  // Contains what was packed with the same sphere.
  [[nodiscard]] Box box(const Sphere& sphere) const noexcept;
};

// Split s brings back vertex base_vertex_count + s. Its bounds contain every face that it or a split below it in the
// forest removes or inserts. Object space, object units.
struct SplitNode {
  Sphere sphere;       // around the subtree
  float error = 0.0F;  // quadric error, about a root mean square distance; no less than that of any split that depends
                       // on this one or is below it in the forest
  float guaranteed_error = 0.0F;  // bound on the distance between the surface without this split and the input; no less
                                  // than below, likewise
  SplitId child_u = no_id;        // forest: the next split of the same parent vertex
  SplitId child_v = no_id;        // forest: the first split of the vertex that this one brings back
  SplitId parent = no_id;         // forest; none at roots
  std::uint32_t star = 0;         // where its SplitStar starts; that of the next node is where it ends
  PackedBounds bounds;            // of the subtree

  // Contains the normals of all faces of the subtree.
  [[nodiscard]] NormalCone cone() const noexcept { return bounds.cone(); }
  // Contains the subtree, and so does box().
  [[nodiscard]] Cylinder cylinder() const noexcept { return bounds.cylinder(sphere); }
  // Contains the subtree.
  [[nodiscard]] Box box() const noexcept { return bounds.box(sphere); }
};
static_assert(sizeof(SplitNode) == 64, "one cache line");

}  // namespace occlod
