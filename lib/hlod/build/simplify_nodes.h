// Makes the nodes of one level by simplifying groups of triangles of the level below, and an HLOD of all levels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.h"
#include "hlod/build/build_journal.h"
#include "hlod/build/finish_level.h"
#include "hlod/build/group_simplifier.h"
#include "hlod/build/group_triangles.h"
#include "hlod/build/level_draft.h"
#include "hlod/store/hlod_data.h"
#include "occlod/build_hlod.h"
#include "splits/build_progress.h"

namespace occlod::hlod {

class NodeSimplifier {
 public:
  // The references must outlive the simplifier. `journal` may be null.
  NodeSimplifier(WedgeMesh& mesh, const HlodBuildOptions& options, const Reduction& reduction, unsigned threads,
                 BuildJournal* journal);

  // Returns the level above `below`, whose parent_of is set to `groups`. Takes nodes from the journal as far as it
  // goes, and then simplifies the remaining groups. Adds wedges to the mesh. `progress` counts triangles of `below`.
  [[nodiscard]] LevelDraft run(LevelDraft& below, TriangleGroups groups, const ProgressPart& progress);

 private:
  class Gatherer;

  void simplify(const LevelDraft& below, std::uint32_t first_group, std::uint32_t group_count, LevelBuilder& level,
                const ProgressPart& progress);
  void simplify_here(const LevelDraft& below, const GroupRules& rules, std::uint32_t first_group,
                     std::uint32_t group_count, LevelBuilder& level, const ProgressPart& progress);
  void simplify_elsewhere(const LevelDraft& below, const GroupRules& rules, std::uint32_t first_group,
                          std::uint32_t group_count, LevelBuilder& level, const ProgressPart& progress);
  [[nodiscard]] std::vector<GroupInput> gather(const LevelDraft& below, std::uint32_t first, std::uint32_t count) const;
  [[nodiscard]] GroupRules rules_of(const LevelDraft& below, std::uint32_t group_count) const;
  // Returns whether vertices that lie within groups move to where they fit best.
  [[nodiscard]] bool refits() const;
  void lock(const LevelDraft& below, std::uint32_t group_count);
  void list_members(const LevelDraft& below, std::uint32_t group_count);
  [[nodiscard]] std::span<const std::uint32_t> members(std::uint32_t group) const;
  [[nodiscard]] float common_cost(const LevelDraft& below, std::uint32_t group_count, const GroupRules& rules) const;
  void finish(SimplifiedNode& result, LevelBuilder& level);
  void join(SimplifiedNode& result, LevelBuilder& level);
  void note(SimplifiedNode& result);
  void pass_on(const LevelDraft& level);

  WedgeMesh& mesh_;
  const HlodBuildOptions& options_;
  Reduction reduction_;
  unsigned threads_;
  BuildJournal* journal_;
  float scale_;
  unsigned level_ = 0;               // that run() makes
  bool has_seams_, has_attributes_;  // of the input
  WedgeId first_added_ = 0;          // wedges from here on are of the unfinished level
  // Vertices that the nodes of that level have lost, and boxes that have grown.
  LargeVector<VertexId> losses_;
  LargeVector<GrownBox> grown_;
  // The next arrays are indexed by vertex of the input mesh.
  UninitializedVector<Box>
      boxes_;  // around the level-0 vertices that were merged into it, and vanished triangles beside it
  // Is 1, with locked borders, if several nodes of the level share the vertex or `lost_` is 1.
  LargeVector<std::uint8_t> locked_;
  // Is 1, with free borders, if several nodes of the level share the vertex: their copies must not part.
  LargeVector<std::uint8_t> shared_;
  // Is 1 once a node that had locked the vertex no longer has it as a corner: it stays locked for ever.
  LargeVector<std::uint8_t> lost_;
  LargeVector<std::uint32_t> members_;       // triangles of the level below, group by group
  std::vector<std::uint32_t> first_member_;  // per group, place of its first triangle in members_; then a sentinel
};

// Numbers nodes from coarse to fine, sorts the triangles of each into patches, and gives each node vertices of its own.
// `levels` from level 0; they are used up. Fills all fields but grouping, borders and node_triangles. The result does
// not depend on the threads. O(n log n) within each node.
[[nodiscard]] HlodData assemble(const WedgeMesh& mesh, std::vector<LevelDraft> levels, Within within, unsigned threads);

}  // namespace occlod::hlod
