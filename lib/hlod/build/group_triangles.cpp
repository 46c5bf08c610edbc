#include "hlod/build/group_triangles.h"

#include <numeric>
#include <utility>

#include "hlod/build/cells.h"
#include "hlod/build/grow_groups.h"
#include "splits/parallel.h"
#include "hlod/build/join_cells.h"
#include "hlod/build/sliver_patches.h"

namespace occlod::hlod {
namespace {

constexpr std::uint32_t reduction = 4;  // triangles of a group to those of the node that is made of it

TriangleGroups by_triangle(const Cells& cells, const CellGroups& groups, unsigned threads) {
  TriangleGroups result{LargeVector<std::uint32_t>(cells.order.size()), groups.count};
  for_each_id(cells.leaf_count(), threads, [&](std::uint32_t cell) {
    make_room();
    for (std::uint32_t i = cells.first_item[cell]; i < cells.first_item[cell + 1]; ++i)
      result.group_of[cells.order[i]] = groups.group_of[cell];
  });
  return result;
}

}  // namespace

TriangleGrouping::TriangleGrouping(const WedgeMesh& mesh, const BuildOptions& options, unsigned threads)
    : mesh_(mesh), options_(options), threads_(threads), grid_(bounding_box(mesh.positions)) {}

glm::dvec3 TriangleGrouping::centroid(const Triangle& t) const {
  return (glm::dvec3(mesh_.positions[t.x]) + glm::dvec3(mesh_.positions[t.y]) + glm::dvec3(mesh_.positions[t.z])) / 3.0;
}

LargeVector<std::uint64_t> TriangleGrouping::codes_of(std::span<const Triangle> triangles, unsigned thirds) const {
  LargeVector<std::uint64_t> codes(triangles.size());
  for_each_id(triangles.size(), threads_,
              [&](std::uint32_t t) { codes[t] = grid_.code(centroid(triangles[t]), thirds); });
  return codes;
}

TriangleGroups TriangleGrouping::group(std::span<const std::uint64_t> codes, std::span<const Triangle> triangles,
                                       std::uint32_t most_triangles, std::span<const std::uint32_t> unit_of) const {
  const Cells cells = make_cells(codes, most_triangles, unit_of, threads_);
  if (options_.grouping == Grouping::nested) return by_triangle(cells, separate_cells(cells), threads_);
  const std::size_t vertices = mesh_.vertex_count();
  TriangleGroups groups =
      by_triangle(cells, join_cells(cells, triangles, vertices, most_triangles, threads_), threads_);
  grow_stuck_groups(triangles, cells.order, vertices, most_triangles, groups, threads_);
  return groups;
}

TriangleGroups TriangleGrouping::group_input() const {
  const auto codes = codes_of(mesh_.triangles, 0);
  return group(codes, mesh_.triangles, options_.node_triangles, {});
}

TriangleGroups TriangleGrouping::group_level(const LevelDraft& below, unsigned level) {
  if (options_.grouping == Grouping::nested) return group_nodes(below);
  const auto codes = codes_of(below.triangles, level % 3);
  TriangleGroups groups = group(codes, below.triangles, reduction * options_.node_triangles, {});
  move_slivers(below, options_.node_triangles, groups, threads_);
  return groups;
}

// All triangles of a node have its code, so that they end up in one cell.
TriangleGroups TriangleGrouping::group_nodes(const LevelDraft& below) {
  if (node_codes_.empty()) find_node_codes(below);
  LargeVector<std::uint64_t> codes(below.triangles.size());
  LargeVector<std::uint32_t> unit_of(below.triangles.size());
  for (std::uint32_t n = 0; n < below.nodes.size(); ++n) {
    make_room();
    const NodeDraft& node = below.nodes[n];
    std::fill_n(codes.begin() + node.first_triangle, node.triangle_count, node_codes_[n]);
    std::fill_n(unit_of.begin() + node.first_triangle, node.triangle_count, n);
  }
  return group(codes, below.triangles, reduction * options_.node_triangles, unit_of);
}

void TriangleGrouping::find_node_codes(const LevelDraft& input) {
  for (const NodeDraft& node : input.nodes)
    node_codes_.push_back(grid_.code(centroid(input.triangles[node.first_triangle]), 0));
}

// The code of a group is that of its last triangle.
void TriangleGrouping::finish_level(const LevelDraft& below, const TriangleGroups& groups) {
  if (options_.grouping != Grouping::nested) return;
  if (node_codes_.empty()) find_node_codes(below);
  std::vector<std::uint64_t> codes_above(groups.count);
  for (std::uint32_t n = 0; n < below.nodes.size(); ++n) {
    make_room();
    const NodeDraft& node = below.nodes[n];
    for (std::uint32_t t = node.first_triangle; t < node.first_triangle + node.triangle_count; ++t)
      codes_above[groups.group_of[t]] = node_codes_[n];
  }
  node_codes_ = std::move(codes_above);
}

}  // namespace occlod::hlod
