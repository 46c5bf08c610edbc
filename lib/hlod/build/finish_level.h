// Removes triangles that cover each other with opposite faces.
#pragma once

#include <cstdint>
#include <vector>

#include "hlod/build/group_triangles.h"
#include "hlod/build/level_draft.h"
#include "occlod/mesh.h"
#include "splits/simplify_group.h"

namespace occlod::hlod {

// Neighbouring nodes may have folded their surfaces onto each other: of each set of triangles with the same corners,
// pairs of opposite winding go, so the oriented boundary stays what it is. The rest keeps its order. Ids are below
// 2^21. `corners`: their wedges, which go with them; empty or as many. Expected O(n).
void cancel_opposite(std::vector<Triangle>& triangles, std::vector<Triangle>& corners);
void cancel_opposite(std::vector<Triangle>& triangles);

// Puts the nodes of one level together: links, bounds and errors.

// What simplification made of one group.
struct SimplifiedNode {
  std::vector<Triangle> triangles;
  std::vector<Triangle> corners;                // their wedges; empty without seams
  std::vector<AddedWedge> added;                // wedges that the WedgeMesh does not have yet: numbered after its own
  std::vector<VertexId> lost;                   // locked vertices that none of the triangles uses
  std::vector<Merge> merges;                    // all wedges of the group that were merged
  std::vector<WedgeId> bare_targets;            // as in NodeDraft
  Box box;                                      // as in Node
  float error = 0.0F, guaranteed_error = 0.0F;  // of this node's own collapses alone
  SplitsDraft within;                           // with Within::splits
};

// Level 0: the groups of the input as they are.
[[nodiscard]] LevelDraft input_level(const WedgeMesh& mesh, const TriangleGroups& groups, unsigned threads);

// The level of the nodes that replace the triangles of `below` by its parent_of. The result does not depend on the
// threads.
class LevelBuilder {
 public:
  // Of so many nodes. All outlive it.
  LevelBuilder(const WedgeMesh& mesh, const LevelDraft& below, std::size_t nodes, unsigned threads);

  // The next node; takes what it has. O(size).
  void append(SimplifiedNode& from);
  // After all nodes. O(n).
  [[nodiscard]] LevelDraft finish();

 private:
  const WedgeMesh& mesh_;
  const LevelDraft& below_;
  unsigned threads_;
  LevelDraft level_;
};

}  // namespace occlod::hlod
