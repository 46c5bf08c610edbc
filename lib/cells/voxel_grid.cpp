#include "cells/voxel_grid.h"

#include <algorithm>
#include <limits>

namespace occlod {
namespace {

template <typename Visit>
void for_each_voxel(const VoxelGrid::Block& block, const Visit& visit) {
  for (int z = block.first[2]; z < block.end[2]; ++z)
    for (int y = block.first[1]; y < block.end[1]; ++y)
      for (int x = block.first[0]; x < block.end[0]; ++x) visit(VoxelGrid::Place{x, y, z});
}

}  // namespace

void VoxelGrid::resize(const Place& size) {
  size_ = size;
  const std::size_t count =
      static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
  taken_.assign(count, 0);
  given_.assign(count, 0);
  edge_.assign(count, 0);
}

std::optional<VoxelGrid::Block> VoxelGrid::next_block() {
  std::optional<Block> block = largest_cube();
  if (!block) return block;
  grow(*block);
  for_each_voxel(*block, [&](const Place& p) { given_[index(p)] = 1; });
  return block;
}

// A cube ends with a voxel if three of one voxel less end with the neighbours before it, and with those between them.
std::optional<VoxelGrid::Block> VoxelGrid::largest_cube() {
  std::uint8_t most = 0;
  Place last{};
  for_each_voxel({{0, 0, 0}, size_}, [&](const Place& p) {
    std::uint8_t& edge = edge_[index(p)];
    edge = 0;
    if (taken_[index(p)] != 0 || given_[index(p)] != 0) return;
    std::uint8_t least = std::numeric_limits<std::uint8_t>::max();
    for (int k = 1; k < 8; ++k) {
      const Place q{p[0] - (k & 1), p[1] - (k >> 1 & 1), p[2] - (k >> 2 & 1)};
      least = q[0] < 0 || q[1] < 0 || q[2] < 0 ? std::uint8_t{0} : std::min(least, edge_[index(q)]);
    }
    edge = static_cast<std::uint8_t>(least + 1);
    if (edge < most) return;
    most = edge;
    last = p;
  });
  if (most == 0) return std::nullopt;
  Block block;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block.first[axis] = last[axis] + 1 - most;
    block.end[axis] = last[axis] + 1;
  }
  return block;
}

bool VoxelGrid::is_free(const Block& block) const {
  bool free = true;
  for_each_voxel(block, [&](const Place& p) { free = free && taken_[index(p)] == 0; });
  return free;
}

void VoxelGrid::grow(Block& block) const {
  for (bool grown = true; grown;) {
    grown = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Block before = block, after = block;
      before.end[axis] = block.first[axis];
      before.first[axis] = block.first[axis] - 1;
      if (before.first[axis] >= 0 && is_free(before)) {
        --block.first[axis];
        grown = true;
      }
      after.first[axis] = block.end[axis];
      after.end[axis] = block.end[axis] + 1;
      if (after.end[axis] <= size_[axis] && is_free(after)) {
        ++block.end[axis];
        grown = true;
      }
    }
  }
}

}  // namespace occlod
