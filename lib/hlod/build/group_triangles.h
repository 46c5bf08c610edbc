// Groups the triangles of one level into the nodes of the next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.h"
#include "hlod/build/cells.h"
#include "hlod/build/level_draft.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"

namespace occlod::hlod {

// Returns, per vertex, 1 where triangles of different groups use it and 0 elsewhere. `group_of` is indexed by triangle.
// The result does not depend on the number of threads, which share O(n * threads) steps.
[[nodiscard]] LargeVector<std::uint8_t> shared_vertices(std::span<const Triangle> triangles,
                                                        std::span<const std::uint32_t> group_of,
                                                        std::size_t vertex_count, unsigned threads);

// Assigns a group to each triangle. Groups are numbered along a Morton curve.
struct TriangleGroups {
  UninitializedVector<std::uint32_t> group_of;  // per triangle
  std::uint32_t count = 0;
};

class TriangleGrouping {
 public:
  TriangleGrouping(const WedgeMesh& mesh, Grouping grouping, const Reduction& reduction, unsigned threads);

  // Groups the input into groups of at most Reduction::node_triangles.
  [[nodiscard]] TriangleGroups group_input() const;
  // Groups the triangles of `below`, the level below `level`, into groups of about Reduction::group_triangles. Nested
  // grouping divides no node.
  [[nodiscard]] TriangleGroups group_level(const LevelDraft& below, unsigned level);
  // Must be called after each level with its groups, whether they come from group_level() or from an earlier build.
  void finish_level(const LevelDraft& below, const TriangleGroups& groups);

 private:
  [[nodiscard]] glm::dvec3 centroid(const Triangle& t) const;
  [[nodiscard]] UninitializedVector<std::uint64_t> codes_of(std::span<const Triangle> triangles, unsigned thirds) const;
  [[nodiscard]] TriangleGroups group(std::span<const std::uint64_t> codes, std::span<const Triangle> triangles,
                                     std::uint32_t max_triangles, std::span<const std::uint32_t> unit_of) const;
  [[nodiscard]] TriangleGroups group_nodes(const LevelDraft& below);
  void find_node_codes(const LevelDraft& input);

  const WedgeMesh& mesh_;
  Grouping grouping_;
  Reduction reduction_;
  unsigned threads_;
  OctreeGrid grid_;
  // With nested groups, holds the code of a point in the cell of each node of the last level.
  std::vector<std::uint64_t> node_codes_;
};

// Regroups triangles along the surface where groups by cells fail. Where triangles are much longer than the cells, as
// on pipes with few bends, several groups share nearly all vertices, so that nothing could be simplified. If the groups
// that have more shared than other corners hold a quarter of the triangles or more, their triangles are grouped anew:
// each group grows from one triangle to those that share a vertex with it, and so on, until it has `max_triangles`; the
// triangles left around it start the next. `order` holds all triangles along a Morton curve, along which groups are
// numbered. O(n).
void grow_stuck_groups(std::span<const Triangle> triangles, std::span<const std::uint32_t> order,
                       std::size_t vertex_count, std::uint32_t max_triangles, TriangleGroups& groups, unsigned threads);

// Avoids patches that are too small to be worth a draw call. A patch is the set of a node's triangles in one group. A
// patch of fewer than Reduction::smallest_patch triangles moves to the group of the same node that shares most vertices
// with it, unless that makes the group larger than Reduction::largest_group. Any assignment of triangles to groups is
// legal. The result does not depend on the number of threads. O(n log n) within each node.
void move_slivers(const LevelDraft& level, const Reduction& reduction, TriangleGroups& groups, unsigned threads);

}  // namespace occlod::hlod
