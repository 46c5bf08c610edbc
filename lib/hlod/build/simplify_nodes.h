// Makes the nodes of one level by simplifying groups of triangles of the level below.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.h"
#include "hlod/build/build_journal.h"
#include "hlod/build/finish_level.h"
#include "hlod/build/group_triangles.h"
#include "hlod/build/level_draft.h"
#include "occlod/build_hlod.h"
#include "splits/build_progress.h"

namespace occlod::hlod {

class NodeSimplifier {
 public:
  // All outlive it; the journal may be null.
  NodeSimplifier(WedgeMesh& mesh, const HlodBuildOptions& options, unsigned threads, BuildJournal* journal);

  // The level above `below`, whose parent_of is set to `groups`: nodes of the journal as far as it goes, then groups
  // simplified. Adds wedges to the mesh. `progress` counts triangles of `below`.
  [[nodiscard]] LevelDraft run(LevelDraft& below, TriangleGroups groups, const ProgressPart& progress);

 private:
  class Worker;

  void simplify(const LevelDraft& below, std::uint32_t first_group, std::uint32_t group_count, LevelBuilder& level,
                const ProgressPart& progress);
  void lock(const LevelDraft& below, std::uint32_t group_count);
  void list_members(const LevelDraft& below, std::uint32_t group_count);
  [[nodiscard]] std::span<const std::uint32_t> members(std::uint32_t group) const;
  [[nodiscard]] float common_cost(const LevelDraft& below, std::uint32_t group_count) const;
  void join(SimplifiedNode& result, LevelBuilder& level);
  void note(SimplifiedNode& result);
  void pass_on(const LevelDraft& level);

  WedgeMesh& mesh_;
  const HlodBuildOptions& options_;
  unsigned threads_;
  BuildJournal* journal_;
  float scale_;
  // What the nodes of a level that is not finished have lost and added.
  LargeVector<VertexId> losses_;
  LargeVector<AddedWedge> added_;
  // By vertex of the input mesh:
  LargeVector<Box> boxes_;              // around the level-0 vertices that were merged into it
  LargeVector<std::uint8_t> locked_;    // with locked borders: several nodes of the level share it, or `lost_`
  LargeVector<std::uint8_t> lost_;      // was locked in a node of whose output it is no corner: stays locked for ever
  LargeVector<std::uint32_t> members_;  // triangles of the level below, group by group
  std::vector<std::uint32_t> first_member_;  // of each group; then a sentinel
};

}  // namespace occlod::hlod
