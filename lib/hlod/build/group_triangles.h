// Groups the triangles of one level into the nodes of the next.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/large_vector.h"
#include "hlod/build/level_draft.h"
#include "occlod/hlod/build.h"
#include "hlod/build/octree_grid.h"
#include "hlod/store/wedge_mesh.h"

namespace occlod::hlod {

// Groups of triangles, numbered along a Morton curve.
struct TriangleGroups {
  LargeVector<std::uint32_t> group_of;  // by triangle
  std::uint32_t count = 0;
};

class TriangleGrouping {
 public:
  TriangleGrouping(const WedgeMesh& mesh, const BuildOptions& options, unsigned threads);

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
                                     std::uint32_t most_triangles, std::span<const std::uint32_t> unit_of) const;
  [[nodiscard]] TriangleGroups group_nodes(const LevelDraft& below);
  void find_node_codes(const LevelDraft& input);

  const WedgeMesh& mesh_;
  const BuildOptions& options_;
  unsigned threads_;
  OctreeGrid grid_;
  std::vector<std::uint64_t> node_codes_;  // with nested groups: of a point in the cell of each node of the last level
};

}  // namespace occlod::hlod
