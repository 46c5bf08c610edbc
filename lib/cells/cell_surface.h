// What hides from cells: the surfaces of all objects in world space, as they are or coarser.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "splits/motion_cut.h"
#include "occlod/core/ids.h"
#include "occlod/mesh/triangle_mesh.h"
#include "occlod/refine/refiner.h"
#include "cells/triangle_bvh.h"

namespace occlod {

// Triangles, what lies beyond their edges, and a tree over them, in whose order they are. Immutable. Of triangles with
// the same three corners one is kept; what has less than three corners is left out.
class CellSurface {
 public:
  // What is left out, for tests: then what is said to be hidden need not be.
  struct Without {
    bool motion = false;    // triangles are taken to be exactly where the input is
    bool topology = false;  // windows and tunnels may have closed
  };

  // Of each object the cut whose faces have moved by no more than max_motion (world units); with 0 the input itself.
  CellSurface(std::span<const RefineObject> objects, double max_motion, const Without& without);
  // Of triangles given as they are, for tests. `moved`: of each, world units; or none.
  CellSurface(std::vector<glm::dvec3> positions, std::span<const Triangle> triangles, std::span<const float> moved);

  [[nodiscard]] std::uint32_t triangle_count() const noexcept { return static_cast<std::uint32_t>(triangles_.size()); }
  [[nodiscard]] const glm::dvec3& corner(std::uint32_t t, int k) const noexcept { return positions_[triangles_[t][k]]; }
  // How far the input that the triangle stands for may be from it, world units.
  [[nodiscard]] double moved(std::uint32_t t) const noexcept { return moved_[t]; }

  // Edge 3 t + k runs from corner k of triangle t to the next. The next one of those between the same corners, in a
  // circle: itself at a border.
  [[nodiscard]] std::uint32_t beyond(std::uint32_t edge) const noexcept { return beyond_[edge]; }
  // Whether an odd number of triangles share it.
  [[nodiscard]] bool is_border(std::uint32_t edge) const noexcept { return is_border_[edge]; }

  // Calls visit(triangle) for triangles that the segment meets, until it returns false. See TriangleBvh.
  template <typename Visit>
  void for_each_hit(const glm::dvec3& from, const glm::dvec3& to, const Visit& visit) const {
    bvh_.for_each_hit(positions_, triangles_, from, to, visit);
  }
  // Whether the segment meets the triangle, up to rounding.
  [[nodiscard]] bool meets(std::uint32_t t, const glm::dvec3& from, const glm::dvec3& to) const {
    return TriangleBvh::meets(corner(t, 0), corner(t, 1), corner(t, 2), from, to - from);
  }
  [[nodiscard]] const TriangleBvh& bvh() const noexcept { return bvh_; }
  // The largest coordinate of any corner.
  [[nodiscard]] double largest_coordinate() const noexcept { return largest_coordinate_; }

 private:
  // `max_motion`: object units.
  [[nodiscard]] static MotionCut cut_of(const Hierarchy& hierarchy, double max_motion, const Without& without);
  // `scale`: of motions, from object to world.
  void add(const RefineObject& object, const MotionCut& cut, double scale);
  void add_triangle(const Triangle& t, double moved);
  void finish();
  void drop_duplicates();
  // Triangles in this order, corners in that in which they ask for them: neighbours lie near each other in memory.
  void sort(std::span<const std::uint32_t> order);
  void join_edges();

  std::vector<glm::dvec3> positions_;
  std::vector<Triangle> triangles_;
  std::vector<float> moved_;  // of triangles, rounded up
  std::vector<std::uint32_t> beyond_;
  std::vector<bool> is_border_;
  double largest_coordinate_ = 0.0;
  TriangleBvh bvh_;
};

}  // namespace occlod
