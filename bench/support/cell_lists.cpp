#include "support/cell_lists.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "cell_sight.h"
#include "occlod/build_hierarchy.h"
#include "occlod/cell_builder.h"
#include "occlod/generate.h"

namespace occlod::bench {
namespace {

constexpr double street = 14.0, pitch = 60.0;  // of generate("city")
constexpr double edge = 3.5;                   // of a cell: four side by side in a street

bool is_in_street(double t) { return std::abs(t - pitch * std::round(t / pitch)) < street / 2.0; }

struct Node {
  Ids common;  // that all cells below have
  std::size_t parent = 0;
};

// Whether there was any cell.
bool add_node(const CellGrid& grid, glm::ivec2 low, int side, std::size_t parent, std::vector<Node>& nodes) {
  const std::size_t n = nodes.size();
  if (side == 1) {
    const std::optional<Ids>& cell = grid.at(low.x, low.y);
    if (cell) nodes.push_back({*cell, parent});
    return cell.has_value();
  }
  nodes.push_back({{}, parent});
  bool is_first = true;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const std::size_t child = nodes.size();
    if (!add_node(grid, low + side / 2 * glm::ivec2(quarter % 2, quarter / 2), side / 2, n, nodes)) continue;
    Ids both;
    std::set_intersection(nodes[n].common.begin(), nodes[n].common.end(), nodes[child].common.begin(),
                          nodes[child].common.end(), std::back_inserter(both));
    nodes[n].common = is_first ? nodes[child].common : std::move(both);
    is_first = false;
  }
  if (is_first) nodes.pop_back();
  return !is_first;
}

CellSubtree packed(const CellGrid& grid, glm::ivec2 low, int side) {
  if (side == 1) {
    const std::optional<Ids>& cell = grid.at(low.x, low.y);
    if (!cell) return {};
    CellSets sets;
    sets.splits.assign(cell->begin(), cell->end());
    CellNode node;
    node.box = {{low.x, low.y, 0}, {low.x + 1, low.y + 1, 1}};
    return leaf_of_tree(node, std::move(sets));
  }
  std::vector<CellSubtree> parts;
  for (int quarter = 0; quarter < 4; ++quarter) {
    CellSubtree part = packed(grid, low + side / 2 * glm::ivec2(quarter % 2, quarter / 2), side / 2);
    if (!part.nodes.empty()) parts.push_back(std::move(part));
  }
  if (parts.empty()) return {};
  return parts.size() == 1 ? std::move(parts[0]) : join(std::move(parts));
}

}  // namespace

CellGrid build_grid(int side) {
  const Hierarchy city = build_hierarchy(generate("city", {{"blocks", 8}, {"facade_cells", 8}}));
  const RefineObject objects[] = {{.hierarchy = &city}};
  const CellOccluders occluders(objects, 0.25);
  CellBuilder builder(objects, &occluders, {.eyes = tool::cube_eyes(1024, 0.1)});
  CellGrid grid{side, {}, static_cast<std::uint32_t>(city.split_count())};
  const double corner = 3.0 * pitch - street / 2.0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const glm::dvec3 low(corner + x * edge, corner + y * edge, 1.0), size(edge, edge, 1.5);
      grid.cells.emplace_back();
      if (!is_in_street(low.x + edge / 2.0) && !is_in_street(low.y + edge / 2.0)) continue;
      grid.cells.back() = builder.build({low, low + size}).objects[0].applied;
    }
  return grid;
}

std::vector<Ids> tree_additions(const CellGrid& grid) {
  std::vector<Node> nodes;
  add_node(grid, {0, 0}, grid.side, 0, nodes);
  std::vector<Ids> added;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    added.push_back(n == 0 ? nodes[n].common : paper::delta(nodes[nodes[n].parent].common, nodes[n].common).added);
  return added;
}

CellSubtree packed_tree(const CellGrid& grid) {
  CellSubtree tree = packed(grid, {0, 0}, grid.side);
  finish(tree);
  return tree;
}

std::vector<Transition> transitions_of(const CellGrid& grid) {
  std::vector<Transition> transitions;
  for (int y = 0; y < grid.side; ++y)
    for (int x = 0; x < grid.side; ++x)
      for (const glm::ivec2 to : {glm::ivec2(x + 1, y), glm::ivec2(x, y + 1)}) {
        if (to.x == grid.side || to.y == grid.side || !grid.at(x, y) || !grid.at(to.x, to.y)) continue;
        transitions.push_back({{x, y}, to, paper::delta(*grid.at(x, y), *grid.at(to.x, to.y))});
      }
  return transitions;
}

}  // namespace occlod::bench
