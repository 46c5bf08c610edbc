// Space as a tree of view cells: where the eye may be, which cell it is in, which cells are near.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "occlod/core/ids.h"
#include "occlod/viewcells/cell_view.h"

namespace occlod {

// Index of a node of a CellTree; no_id: none.
using CellId = std::uint32_t;

// A node: a box of space. The boxes of the leaves are the view cells. Nodes are numbered in depth-first order, a parent
// before its children, so the nodes below `n` are n + 1 to end - 1.
struct CellNode {
  CellBox box;                        // holds the boxes of all nodes below, which touch but do not overlap (those of
                                      // different regions may)
  std::uint64_t payload = 0;          // where what it adds begins, bytes from the start of section DATA
  std::uint64_t checksum = 0;         // XXH3-64 of that
  std::uint32_t payload_bytes = 0;    // and its length
  CellId parent = no_id;              // no_id: of the first node, which is the root
  CellId end = 0;                     // one past the last node below
  std::uint32_t level = 0;            // nodes above it
  std::uint32_t splits = 0;           // that it adds, of all objects
  std::uint32_t hidden_faces = 0;     // that it adds
  std::uint32_t triangles = 0;        // of a leaf: active ones in its cut
  std::uint32_t drawn_triangles = 0;  // of a leaf: of these, to draw
  float error_px = 0.0F;              // of a leaf: how far anything seen is from what is drawn, at most
  std::uint32_t candidates = 0;       // CellAdditions::candidates
};
static_assert(sizeof(CellNode) == 104);

// Immutable; any number of threads may use one.
class CellTree {
 public:
  // Throws Error when `nodes` are no tree in depth-first order, a box is not finite or inverted, or reaches out of its
  // parent's. `subject`: of the error. O(nodes).
  CellTree(std::vector<CellNode> nodes, const std::string& subject);

  // At least one.
  [[nodiscard]] std::span<const CellNode> nodes() const noexcept { return nodes_; }
  // cell < nodes().size().
  [[nodiscard]] const CellNode& node(CellId cell) const noexcept { return nodes_[cell]; }
  // Whether it is a view cell: no node is below it.
  [[nodiscard]] bool is_leaf(CellId cell) const noexcept { return nodes_[cell].end == cell + 1; }
  // View cells.
  [[nodiscard]] std::uint32_t leaf_count() const noexcept { return leaf_count_; }

  // The leaf whose closed box holds the eye (world space), that with the smallest id on a border; no_id outside all.
  // O(depth).
  [[nodiscard]] CellId leaf_of(const glm::dvec3& eye) const;
  // The leaf whose box is nearest to the eye, that with the smallest id if several are. O(depth), typically.
  [[nodiscard]] CellId nearest_leaf(const glm::dvec3& eye) const;
  // All leaves whose closed boxes meet the closed box, ascending. Clears `out`.
  void leaves_in(const CellBox& box, std::vector<CellId>& out) const;
  // The leaves that share a piece of a face with this one, ascending. Clears `out`.
  void neighbours(CellId leaf, std::vector<CellId>& out) const;
  // From the root to the cell, both with it. Clears `out`.
  void path_to(CellId cell, std::vector<CellId>& out) const;
  // The deepest node that is above both or one of them.
  [[nodiscard]] CellId common_ancestor(CellId a, CellId b) const noexcept;

 private:
  std::vector<CellNode> nodes_;
  std::uint32_t leaf_count_ = 0;
};

}  // namespace occlod
