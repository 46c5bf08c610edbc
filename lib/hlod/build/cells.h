// Assigns points to the cells of octrees that are moved from level to level, and joins small cells.
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

// Spans twice the extent W of a mesh, so that the octree can be moved by up to two thirds of W and still covers the
// mesh. Coordinates are integers in units of W / (3 * 2^20), so thirds are exact. A third of W is a third of every cell
// size, give or take whole cells: the planes of two octrees that are moved by different thirds are at least a third of
// the smaller cell apart.
class OctreeGrid {
 public:
  static constexpr unsigned depth = 21;  // levels of cells below the root; the finest are 2^-20 W wide

  explicit OctreeGrid(const Box& box);

  // Returns the path from the root to the finest cell that holds p as a Morton code: 3 bits per level, with the root's
  // in the highest of 63 bits. The octree is moved by `thirds` (0, 1 or 2) thirds of W on every axis. Points outside
  // the mesh's box count as on its border.
  [[nodiscard]] std::uint64_t code(const glm::dvec3& p, unsigned thirds) const;

  // Returns which of its parent's eight cells a code goes through at this depth >= 1.
  [[nodiscard]] static unsigned octant(std::uint64_t code, unsigned at_depth) {
    return static_cast<unsigned>(code >> 3U * (depth - at_depth)) & 7U;
  }

 private:
  glm::dvec3 origin_;
  double units_per_length_ = 0.0;
};

// A run of leaf cells.
struct LeafRange {
  std::uint32_t first = 0;
  std::uint32_t end = 0;
};

// Holds an octree whose cells are split until none has too many items.
struct Cells {
  UninitializedVector<std::uint32_t> order;  // items along the Morton curve; equal codes are ordered by id
  std::vector<std::uint32_t> first_item;     // per leaf cell, place of its first item in `order`; then a sentinel
  std::vector<LeafRange> inner;  // leaves below each inner cell, which are consecutive; children come before parents
  [[nodiscard]] std::uint32_t leaf_count() const { return static_cast<std::uint32_t>(first_item.size() - 1); }
  [[nodiscard]] std::uint32_t item_count(std::uint32_t leaf) const { return first_item[leaf + 1] - first_item[leaf]; }
};

// Builds the octree of items from their codes in an OctreeGrid. A finest cell that still holds more than `max_items` is
// cut by id into runs of that size. Items with equal unit_of[id], which are consecutive, stay together as far as they
// fit into one cell; if `unit_of` is empty, every item is its own unit. O(n).
[[nodiscard]] Cells make_cells(std::span<const std::uint64_t> codes, std::uint32_t max_items,
                               std::span<const std::uint32_t> unit_of, unsigned threads);

// Assigns a group to each leaf cell. Groups are numbered along the Morton curve of their first cells.
struct CellGroups {
  std::vector<std::uint32_t> group_of;
  std::uint32_t count = 0;
};

// In each inner cell, from the finest to the root, joins the two groups that share most vertices for their size as long
// as both together have at most `max_triangles`; groups with less than half as many are handed up to the next cell. The
// items of `cells` are ids of triangles. The result does not depend on the number of threads. O(n + cells log cells).
[[nodiscard]] CellGroups join_cells(const Cells& cells, std::span<const Triangle> triangles, std::size_t vertex_count,
                                    std::uint32_t max_triangles, unsigned threads);

// Returns one group for each leaf cell.
[[nodiscard]] CellGroups separate_cells(const Cells& cells);

}  // namespace occlod::hlod
