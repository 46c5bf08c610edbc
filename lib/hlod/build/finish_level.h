// Puts the nodes of one level together: computes links, bounds and errors, and removes triangles that cancel out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hlod/build/group_triangles.h"
#include "hlod/build/level_draft.h"
#include "occlod/mesh.h"
#include "splits/simplify_group.h"

namespace occlod::hlod {

// Removes pairs of triangles with the same corners and opposite winding that merging has folded onto each other, so
// that the oriented boundary is unchanged. `before` holds each triangle as it was before merging: those that had the
// same corners already, such as both sides of a sheet, stay. The remaining triangles keep their order. Ids must be
// below 2^21. `corners` holds the triangles' wedges, which are removed with them, or is empty. Expected O(n).
void cancel_folded(std::vector<Triangle>& triangles, std::vector<Triangle>& corners, std::span<const Triangle> before);

// Records that everything in `box`, which a vertex stood for or triangles beside it, now depends on this vertex.
struct GrownBox {
  VertexId vertex = no_id;
  Box box;
};

// Holds the result of simplifying one group.
struct SimplifiedNode {
  std::vector<Triangle> triangles;
  std::vector<Triangle> corners;                // wedges of the triangles; empty where each vertex is its own wedge
  std::vector<NewWedge> added;                  // that the WedgeMesh does not have yet, numbered after its own
  std::vector<VertexId> lost;                   // locked vertices that none of the triangles uses
  std::vector<Merge> merges;                    // all wedges of the group that were merged or have moved
  std::vector<WedgeId> bare_targets;            // see NodeDraft
  Box box;                                      // of what its input stands for, without what vanished below it
  std::vector<GrownBox> grown;                  // of vertices that triangles still use, for what vanished beside them
  std::vector<Box> vanished;                    // at most one: of what vanished and left no triangle beside it
  float error = 0.0F, guaranteed_error = 0.0F;  // of this node's own collapses alone
  SplitsDraft within;                           // filled with Within::splits
};

// Returns level 0: the groups of the input as they are.
[[nodiscard]] LevelDraft input_level(const WedgeMesh& mesh, const TriangleGroups& groups, unsigned threads);

// Builds the level of the nodes that replace the triangles of `below`, as its parent_of says. The result does not
// depend on the number of threads.
class LevelBuilder {
 public:
  // Prepares for this number of nodes. The references must outlive the builder.
  LevelBuilder(const WedgeMesh& mesh, const LevelDraft& below, std::size_t nodes, unsigned threads);

  // Appends the next node and moves its arrays out of `from`. O(size).
  void append(SimplifiedNode& from);
  // Returns the level, after all nodes were appended. O(n).
  [[nodiscard]] LevelDraft finish();

 private:
  const WedgeMesh& mesh_;
  const LevelDraft& below_;
  unsigned threads_;
  LevelDraft level_;
};

}  // namespace occlod::hlod
