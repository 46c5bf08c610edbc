// Cuts polygons into triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/base.h"
#include "occlod/mesh.h"

namespace occlod {

// Cuts polygons into triangles. Keeps its scratch memory from polygon to polygon. `positions` outlives it.
class Triangulator {
 public:
  // A step looks at a corner or at a cell of a grid.
  explicit Triangulator(std::span<const glm::vec3> positions, std::size_t max_steps = std::size_t{1} << 30)
      : positions_(positions), max_steps_(max_steps) {}

  // Appends corners.size() - 2 triangles with the polygon's winding: a fan if it is strictly convex, otherwise ears
  // clipped in the plane of its area vector (Newell). A polygon that crosses itself or lies on a line becomes a fan.
  // There must be at least three corners, with finite positions. Returns false, with nothing appended, when clipping
  // takes more than max_steps, which are some seconds; spirals of 100,000 corners take half of them.
  template <class Triangles>  // a vector or a LargeVector
  [[nodiscard]] bool append(std::span<const VertexId> corners, Triangles& triangles);

 private:
  // The remaining corners of a polygon in a square of cells, about as many as corners, each with a list of its corners.
  class Grid {
   public:
    void build(std::span<const glm::dvec2> points, std::span<const std::uint32_t> next, std::uint32_t first,
               std::size_t count);
    // Returns a remaining corner in the cells of the box that passes the test, or no_id.
    template <class Test>
    [[nodiscard]] std::uint32_t find(const glm::dvec2& low, const glm::dvec2& high, std::size_t& steps,
                                     const Test& test) const;
    void remove(std::uint32_t corner, const glm::dvec2& at);

   private:
    [[nodiscard]] glm::ivec2 cell_of(const glm::dvec2& at) const;
    [[nodiscard]] std::size_t index_of(const glm::ivec2& cell) const {
      return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(cell.x);
    }

    int side_ = 0;
    glm::dvec2 low_{0.0};
    glm::dvec2 cells_per_unit_{0.0};
    std::vector<std::uint32_t> first_;  // corner in each cell; no_id: none
    std::vector<std::uint32_t> next_;   // corner in the same cell, by corner
  };

  [[nodiscard]] bool project(std::span<const VertexId> corners);
  [[nodiscard]] bool is_strictly_convex() const;
  enum class Clipping { done, crosses_itself, takes_too_long };
  template <class Triangles>
  [[nodiscard]] Clipping clip_ears(std::span<const VertexId> corners, Triangles& triangles);
  [[nodiscard]] bool is_ear(std::uint32_t tip, bool allow_flat);
  void unlink(std::uint32_t corner);
  [[nodiscard]] double turn_at(std::uint32_t corner) const;

  std::span<const glm::vec3> positions_;
  std::size_t max_steps_;
  std::vector<glm::dvec2> points_;   // the polygon in its plane, counter-clockwise
  std::vector<std::uint32_t> next_;  // next remaining corner of each corner
  std::vector<std::uint32_t> previous_;
  std::vector<std::uint32_t> blockers_;  // by corner: the last corner that was found in its triangle, or no_id
  Grid grid_;
  bool uses_grid_ = false;  // only for large polygons
  std::size_t steps_ = 0;   // so far, for the current polygon
};

}  // namespace occlod
