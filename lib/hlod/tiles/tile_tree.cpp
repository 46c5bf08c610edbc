#include "hlod/tiles/tile_tree.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace occlod::tiles {
namespace {

// The least error above another: one that clients tell apart also as floats.
double above(double error, double extent) { return std::max(error * (1.0 + 1e-6), extent * 1e-9); }

}  // namespace

hlod::NodeId parent_of(const hlod::Hlod& hlod, hlod::NodeId n) {
  return hlod.patches(n).empty() ? no_id : hlod.patches(n)[0].parent;
}

void TileTree::complete(TileError error, std::uint32_t tiles_per_file) {
  // Children come after their parents.
  for (hlod::NodeId n = static_cast<hlod::NodeId>(tiles_.size()); n-- > 0;) {
    bound(n, error);
    const std::span<const hlod::NodeId> children = hlod_.children(n);
    divide({children.begin(), children.end()}, tiles_per_file, tiles_[n].extent);
  }
  double largest = 0.0;
  for (const hlod::NodeId n : hlod_.data().roots) {
    box_.take(tiles_[n].box);
    largest = std::max(largest, tiles_[n].error);
  }
  const double diagonal = glm::length(box_.max - box_.min);
  error_ = std::max(diagonal, above(largest, diagonal));
  std::uint32_t extent = 1;
  const std::span<const hlod::NodeId> roots = hlod_.data().roots;
  if (roots.size() > 1) divide({roots.begin(), roots.end()}, tiles_per_file, extent);
}

void TileTree::bound(hlod::NodeId n, TileError error) {
  const hlod::Node& node = hlod_.node(n);
  Tile& tile = tiles_[n];
  tile.content_box = tile.content_box.is_empty() ? tile.content_box : thickened(tile.content_box);
  tile.box = tile.content_box;
  double childrens = 0.0;
  for (const hlod::NodeId child : hlod_.children(n)) {
    tile.box.take(tiles_[child].box);
    childrens = std::max(childrens, tiles_[child].error);
  }
  if (node.children == 0) return;
  const double own = error == TileError::guaranteed ? node.guaranteed_error : node.error;
  tile.error = std::max(own, above(childrens, glm::length(tile.box.max - tile.box.min)));
}

void TileTree::divide(std::vector<hlod::NodeId> children, std::uint32_t tiles_per_file, std::uint32_t& extent) {
  std::uint64_t sum = 1;
  for (const hlod::NodeId child : children) sum += tiles_[child].extent;
  std::stable_sort(children.begin(), children.end(),
                   [&](hlod::NodeId a, hlod::NodeId b) { return tiles_[a].extent > tiles_[b].extent; });
  for (const hlod::NodeId child : children) {
    if (sum <= tiles_per_file || tiles_[child].extent == 1) break;
    sum -= tiles_[child].extent - 1;
    tiles_[child].is_external = true;
  }
  extent = static_cast<std::uint32_t>(sum);
}

}  // namespace occlod::tiles
