// Which vertices several groups use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.h"
#include "hlod/build/cells.h"
#include "hlod/build/level_draft.h"
#include "occlod/build_hlod.h"
#include "occlod/mesh.h"

namespace occlod::hlod {

// By vertex: 1 where triangles of different groups use it, 0 elsewhere. `group_of` by triangle. The result does not
// depend on the threads. O(n * threads) steps, shared by them.
[[nodiscard]] LargeVector<std::uint8_t> shared_vertices(std::span<const Triangle> triangles,
                                                        std::span<const std::uint32_t> group_of,
                                                        std::size_t vertex_count, unsigned threads);

// Groups the triangles of one level into the nodes of the next.

// Groups of triangles, numbered along a Morton curve.
struct TriangleGroups {
  LargeVector<std::uint32_t> group_of;  // by triangle
  std::uint32_t count = 0;
};

class TriangleGrouping {
 public:
  TriangleGrouping(const WedgeMesh& mesh, const HlodBuildOptions& options, unsigned threads);

  // Of the input: at most node_triangles in each group.
  [[nodiscard]] TriangleGroups group_input() const;
  // Of a level, the one below `level`: about four times as many. With nested groups no node is divided.
  [[nodiscard]] TriangleGroups group_level(const LevelDraft& below, unsigned level);
  // After each level, with its groups, whether they come from group_level() or are known from an earlier build.
  void finish_level(const LevelDraft& below, const TriangleGroups& groups);

 private:
  [[nodiscard]] glm::dvec3 centroid(const Triangle& t) const;
  [[nodiscard]] LargeVector<std::uint64_t> codes_of(std::span<const Triangle> triangles, unsigned thirds) const;
  [[nodiscard]] TriangleGroups group(std::span<const std::uint64_t> codes, std::span<const Triangle> triangles,
                                     std::uint32_t max_triangles, std::span<const std::uint32_t> unit_of) const;
  [[nodiscard]] TriangleGroups group_nodes(const LevelDraft& below);
  void find_node_codes(const LevelDraft& input);

  const WedgeMesh& mesh_;
  const HlodBuildOptions& options_;
  unsigned threads_;
  OctreeGrid grid_;
  std::vector<std::uint64_t> node_codes_;  // with nested groups: of a point in the cell of each node of the last level
};

// Groups along the surface, where cells of space do not work.

// Where triangles are much longer than the cells that so many of them fill, as on pipes with few bends, nearly all
// vertices are shared by several groups, so that nothing could be simplified. If groups with more shared corners than
// others have a quarter of the triangles or more, their triangles are grouped anew: from one triangle to those that
// share a vertex with it, and so on, until a group has `max_triangles`; what is left around it begins the next.
// `order` is all triangles along a Morton curve; groups are numbered along it. O(n).
void grow_stuck_groups(std::span<const Triangle> triangles, std::span<const std::uint32_t> order,
                       std::size_t vertex_count, std::uint32_t max_triangles, TriangleGroups& groups, unsigned threads);

// Spares patches that are too small to be worth a draw call.

// A patch is what a node has in one group. Those with less than a 32nd of `node_triangles` triangles move to the group
// of the same node that shares most vertices with them, unless that makes a group too large for 16-bit indices. Any
// assignment of triangles to groups is legal. The result does not depend on the threads. O(n log n) within each node.
void move_slivers(const LevelDraft& level, std::uint32_t node_triangles, TriangleGroups& groups, unsigned threads);

}  // namespace occlod::hlod
