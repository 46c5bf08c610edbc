// Refinement within nodes (Charalambos 2006, sec. 4.4): the mesh of a node with some of its collapses undone, so that
// its error is anything between its own and its children's. For HLODs built with Within::splits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "occlod/hlod/hlod.h"

namespace occlod::hlod {

// A node's mesh with its first splits applied. It may be drawn in place of the node when all the node's parents are
// refined, or else not drawn and out of sight: it has no patches. Whatever its neighbours are drawn with, no gap opens
// where borders are locked (docs/decisions/029-cuts_within_nodes.md).
struct NodeCut {
  std::uint32_t splits = 0;            // how many; 0: the node's mesh as it is
  std::vector<std::uint16_t> indices;  // three for each triangle: into NodeMesh::positions, then NodeSplits::positions
};

// How many splits leave an error of at most `most_error` (object units): none when that is Node::error or more, all
// that change anything when it is Node::child_error or less. 0 for a node without splits, which else have been
// required. O(log splits).
[[nodiscard]] std::uint32_t splits_to_error(const Hlod& hlod, NodeId n, double most_error);

// The error of drawing node n with its first splits applied instead of the input: between Node::child_error and
// Node::error. splits <= NodeWithin::splits; the node's splits have been required. O(1).
[[nodiscard]] double error_of_splits(const Hlod& hlod, NodeId n, std::uint32_t splits);

// The mesh of node n, which has_within() and whose splits have been required, with its first splits applied, or some
// more where the last one is of a place that others are at. O(triangles that the node was made from), times their
// logarithm where the input has seams.
[[nodiscard]] NodeCut cut_with_splits(const Hlod& hlod, NodeId n, std::uint32_t splits);

// The coarsest mesh of node n whose error is at most `most_error`, object units; the finest if none is. Requires what
// it needs, so it throws Error when a mapped file is damaged. O(triangles that the node was made from).
[[nodiscard]] NodeCut within_cut(const Hlod& hlod, NodeId n, double most_error);

// The largest 2^(i/4), i an integer, that is at most x; 0 for 0. x >= 0; of infinity the largest that is finite.
[[nodiscard]] double error_step(double x);

// Cuts of nodes, kept from frame to frame. Errors are rounded down to error_step(), so that a node's cut changes only
// when its error has changed by a fifth. One thread at a time.
class CutCache {
 public:
  // Empty.
  explicit CutCache(std::size_t most_bytes = std::size_t{64} << 20U);
  CutCache(CutCache&&) noexcept;
  CutCache& operator=(CutCache&&) noexcept;
  ~CutCache();

  // Starts a frame: drops cuts, the longest unused first, while all have more than `most_bytes`.
  void begin_frame();
  // within_cut() to error_step(most_error). Valid until the next begin_frame(). `hlod` stays where it is as long as the
  // cache is used; cuts without splits have no indices: draw the node's own. Throws Error when a mapped file is
  // damaged.
  [[nodiscard]] const NodeCut& get(const Hlod& hlod, NodeId n, double most_error);
  // Of all cuts that are kept.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod::hlod
