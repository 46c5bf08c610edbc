// Places of points in octrees that are moved from level to level.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "base/memory.h"
#include "occlod/bounds.h"
#include "occlod/mesh.h"

namespace occlod::hlod {

// An octree over twice the extent W of a mesh, so that it can be moved by up to two thirds of W and still cover it.
// Coordinates are integers of W / (3 * 2^20), so thirds are exact. A third of W is a third of every cell size, give or
// take whole cells: planes of two octrees that are moved by different thirds stay a third of the smaller cell apart.
class OctreeGrid {
 public:
  static constexpr unsigned depth = 21;  // levels of cells below the root; the finest are 2^-20 W wide

  explicit OctreeGrid(const Box& box);

  // The path from the root to the finest cell that holds p, 3 bits a level, the root's in the highest of 63: a Morton
  // code. `thirds` in {0, 1, 2}: how many thirds of W the octree is moved by, on every axis. Points outside the mesh's
  // box count as on its border.
  [[nodiscard]] std::uint64_t code(const glm::dvec3& p, unsigned thirds) const;

  // Which of its parent's eight cells a code goes through at this depth >= 1.
  [[nodiscard]] static unsigned octant(std::uint64_t code, unsigned at_depth) {
    return static_cast<unsigned>(code >> 3U * (depth - at_depth)) & 7U;
  }

 private:
  glm::dvec3 origin_;
  double units_per_length_ = 0.0;
};

// The cells of one level's octree.

// A run of leaf cells.
struct LeafRange {
  std::uint32_t first = 0;
  std::uint32_t end = 0;
};

// An octree whose cells are split until none holds too many items.
struct Cells {
  LargeVector<std::uint32_t> order;       // items along the Morton curve, equal codes by id
  std::vector<std::uint32_t> first_item;  // of each leaf cell, into `order`; then a sentinel
  std::vector<LeafRange> inner;           // the leaves below each inner cell, children before their parents; those of
                                          // a cell are consecutive
  [[nodiscard]] std::uint32_t leaf_count() const { return static_cast<std::uint32_t>(first_item.size() - 1); }
  [[nodiscard]] std::uint32_t item_count(std::uint32_t leaf) const { return first_item[leaf + 1] - first_item[leaf]; }
};

// Of items by their codes in an OctreeGrid. Where the finest cell still holds more than `max_items`, it is cut into
// runs of so many by id; items with equal unit_of[id], which are consecutive, stay together as far as they fit into one
// cell; empty: every item is a unit. O(n).
[[nodiscard]] Cells make_cells(std::span<const std::uint64_t> codes, std::uint32_t max_items,
                               std::span<const std::uint32_t> unit_of, unsigned threads);

// Joins small neighbouring cells of an octree to groups of nearly the wanted size.

// The group of each leaf cell. Groups are numbered along the Morton curve of their first cells.
struct CellGroups {
  std::vector<std::uint32_t> group_of;
  std::uint32_t count = 0;
};

// Within each inner cell, from the finest to the root, joins the two groups that share most vertices for their size as
// long as both together have at most `max_triangles`; what has less than half as many is handed up to the next cell.
// Cells hold triangles, by id. The result does not depend on the threads. O(n + cells log cells).
[[nodiscard]] CellGroups join_cells(const Cells& cells, std::span<const Triangle> triangles, std::size_t vertex_count,
                                    std::uint32_t max_triangles, unsigned threads);

// Every leaf cell is a group.
[[nodiscard]] CellGroups separate_cells(const Cells& cells);

}  // namespace occlod::hlod
