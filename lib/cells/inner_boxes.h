// Finds the largest free blocks in a grid of voxels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cells/cell_surface.h"

namespace occlod {

// A small grid of voxels, some of them taken.
class VoxelGrid {
 public:
  using Place = std::array<int, 3>;
  // Holds voxels from `first` to before `end`, in each axis.
  struct Block {
    Place first{}, end{};
  };

  // Resizes and clears the grid.
  void resize(const Place& size);
  [[nodiscard]] const Place& size() const noexcept { return size_; }

  void take(const Place& p) { taken_[index(p)] = 1; }
  [[nodiscard]] bool is_taken(const Place& p) const { return taken_[index(p)] != 0; }
  // Returns the largest cube without taken voxels, the last in order of x, y and z among equals, extended by as many
  // layers at each side as are free. Its voxels are marked as used: no later block starts with them, though it may grow
  // over them. Returns nothing where no voxel is left. O(voxels).
  [[nodiscard]] std::optional<Block> next_block();

 private:
  [[nodiscard]] std::size_t index(const Place& p) const {
    return (static_cast<std::size_t>(p[2]) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(p[1])) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(p[0]);
  }
  [[nodiscard]] std::optional<Block> largest_cube();
  [[nodiscard]] bool is_free(const Block& block) const;
  void grow(Block& block) const;

  Place size_{};
  std::vector<std::uint8_t> taken_;  // per voxel
  std::vector<std::uint8_t> given_;  // per voxel: used by an earlier block
  std::vector<std::uint8_t> edge_;   // per voxel: edge of the largest free cube that ends there
};

// Finds boxes of space inside the solids of a surface: the fastest proof that something is hidden.

// A *part* is a set of triangles connected over edges. If a part as a whole hides a box of space from a cell (see
// HullTest), it hides everything that is visible only through that box, because each segment from the cell to it meets
// the part before the box. That test is fast, as both are convex: it succeeds iff the segments from corners to corners
// meet the box.
//
// So boxes inside solids are found here, once. No triangle comes closer to one than it may have moved. Whether a box is
// hidden from a cell has to be tested per cell. Immutable.
class InnerBoxes {
 public:
  static constexpr std::size_t max_boxes = 4;       // per part
  static constexpr std::size_t max_parts = 4096;    // that are examined: those with the largest bounds
  static constexpr std::size_t max_borders = 4096;  // of a part with boxes
  static constexpr int resolution = 32;             // voxels along the longest edge of a part's bounds
  static constexpr std::size_t min_triangles = 8;   // of a part with boxes

  struct Part {
    std::uint32_t first_box = 0, box_count = 0;
    std::uint32_t first_border = 0, border_count = 0;
  };

  InnerBoxes() = default;
  // Finds the boxes. Typically O(n), plus some thousand steps for each part that is examined.
  explicit InnerBoxes(const CellSurface& surface);

  // Returns the part of a triangle.
  [[nodiscard]] std::uint32_t part_of(std::uint32_t t) const { return part_of_[t]; }
  [[nodiscard]] const Part& part(std::uint32_t p) const { return parts_[p]; }
  [[nodiscard]] std::size_t part_count() const noexcept { return parts_.size(); }
  // Returns the boxes of all parts; those of one part are consecutive.
  [[nodiscard]] std::span<const CellBox> boxes() const noexcept { return boxes_; }
  // Returns the part of a box.
  [[nodiscard]] std::uint32_t owner(std::uint32_t box) const { return owners_[box]; }
  // Returns the edges (see CellSurface::beyond) that an odd number of the part's triangles share.
  [[nodiscard]] std::span<const std::uint32_t> borders(const Part& part) const {
    return std::span(borders_).subspan(part.first_border, part.border_count);
  }
  // Returns the largest distance of any triangle from the input.
  [[nodiscard]] double largest_motion() const noexcept { return largest_motion_; }

 private:
  void find_parts(const CellSurface& surface);
  [[nodiscard]] std::vector<std::uint32_t> parts_worth_a_look(const CellSurface& surface) const;
  void add_boxes(const CellSurface& surface, std::uint32_t part, std::span<const std::uint32_t> triangles);

  std::vector<std::uint32_t> part_of_;
  std::vector<Part> parts_;
  std::vector<CellBox> boxes_;
  std::vector<std::uint32_t> owners_;
  std::vector<std::uint32_t> borders_;
  double largest_motion_ = 0.0;
};

}  // namespace occlod
