#include "cells/inner_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <optional>
#include <utility>

#include "cells/cell_geometry.h"
#include "cells/hull.h"

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

// The largest free cube that ends at a voxel has edge n if cubes of edge n - 1 end at the preceding neighbours along
// all axes and diagonals.
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

namespace {

constexpr CellBox empty_box{glm::dvec3(std::numeric_limits<double>::infinity()),
                            glm::dvec3(-std::numeric_limits<double>::infinity())};
// Relative rounding error of coordinates.
constexpr double relative_rounding = 1e-9;
// A block is rejected when it is this many times smaller than the first block of its part.
constexpr double min_share = 1.0 / 16.0;
// A voxel counts as inside a solid if this many of its six directions meet surface before the end of the grid; a house
// may be open on one side.
constexpr int min_sides = 5;

CellBox bounds_of(const CellSurface& surface, std::uint32_t t) {
  const glm::dvec3 &a = surface.corner(t, 0), &b = surface.corner(t, 1), &c = surface.corner(t, 2);
  return grown({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))}, surface.moved(t));
}

CellBox bounds_of_edge(const CellSurface& surface, std::uint32_t edge) {
  const std::uint32_t t = edge / 3, k = edge % 3;
  const glm::dvec3 &a = surface.corner(t, static_cast<int>(k)),
                   &b = surface.corner(t, k == 2 ? 0 : static_cast<int>(k) + 1);
  return grown({glm::min(a, b), glm::max(a, b)}, surface.moved(t));
}

double volume_of(const CellBox& box) {
  const glm::dvec3 size = box.max - box.min;
  return size.x * size.y * size.z;
}

// Voxelizes a part.
class PartGrid {
 public:
  PartGrid(const CellSurface& surface, std::span<const std::uint32_t> triangles) : surface_(surface) {
    for (const std::uint32_t t : triangles) bounds_ = unite(bounds_, bounds_of(surface, t));
    const glm::dvec3 size = bounds_.max - bounds_.min;
    edge_ = std::max({size.x, size.y, size.z}) / InnerBoxes::resolution;
    VoxelGrid::Place counts;
    for (int axis = 0; axis < 3; ++axis)
      counts[static_cast<std::size_t>(axis)] =
          std::clamp(static_cast<int>(std::ceil(size[axis] / edge_)), 1, InnerBoxes::resolution);
    grid_.resize(counts);
    for (const std::uint32_t t : triangles) take(t);
    take_outside();
  }

  // Returns the next box, or nothing where there is none, or only flat ones.
  [[nodiscard]] std::optional<CellBox> next_box() {
    const std::optional<VoxelGrid::Block> block = grid_.next_block();
    if (!block) return std::nullopt;
    return CellBox{corner(block->first), corner(block->end)};
  }
  [[nodiscard]] const CellBox& bounds() const noexcept { return bounds_; }
  [[nodiscard]] double edge() const noexcept { return edge_; }  // edge length of a voxel

 private:
  [[nodiscard]] glm::dvec3 corner(const VoxelGrid::Place& p) const {
    return bounds_.min + edge_ * glm::dvec3(p[0], p[1], p[2]);
  }

  void take(std::uint32_t t) {
    const CellBox box = bounds_of(surface_, t);
    const double margin = surface_.moved(t) + relative_rounding * surface_.largest_coordinate();
    VoxelGrid::Place first{}, last{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      const auto place = [&](double x) {
        return std::clamp(static_cast<int>(std::floor((x - bounds_.min[axis]) / edge_)), 0, grid_.size()[k] - 1);
      };
      // Takes one more voxel to each side, because the triangle may touch the border of a voxel.
      first[k] = std::max(place(box.min[axis]) - 1, 0);
      last[k] = std::min(place(box.max[axis]) + 1, grid_.size()[k] - 1);
    }
    for (int z = first[2]; z <= last[2]; ++z)
      for (int y = first[1]; y <= last[1]; ++y)
        for (int x = first[0]; x <= last[0]; ++x) {
          const VoxelGrid::Place p{x, y, z};
          if (grid_.is_taken(p)) continue;
          const CellBox voxel = grown({corner(p), corner({x + 1, y + 1, z + 1})}, margin);
          if (triangle_meets(surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2), voxel)) grid_.take(p);
        }
  }

  // Marks voxels outside the solid as taken. This is only a heuristic that avoids boxes that can hide nothing.
  void take_outside() {
    const VoxelGrid::Place& size = grid_.size();
    std::vector<std::uint8_t> sides(
        static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]), 0);
    const auto place_of = [&](const VoxelGrid::Place& p) {
      return static_cast<std::size_t>((p[2] * size[1] + p[1]) * size[0] + p[0]);
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      VoxelGrid::Place p{};
      for (p[u] = 0; p[u] < size[u]; ++p[u])
        for (p[v] = 0; p[v] < size[v]; ++p[v])
          for (const bool upwards : {true, false}) {
            bool behind = false;
            for (int i = 0; i < size[axis]; ++i) {
              p[axis] = upwards ? i : size[axis] - 1 - i;
              behind = behind || grid_.is_taken(p);
              if (behind) ++sides[place_of(p)];
            }
          }
    }
    VoxelGrid::Place p{};
    for (p[2] = 0; p[2] < size[2]; ++p[2])
      for (p[1] = 0; p[1] < size[1]; ++p[1])
        for (p[0] = 0; p[0] < size[0]; ++p[0])
          if (sides[place_of(p)] < min_sides) grid_.take(p);
  }

  const CellSurface& surface_;
  CellBox bounds_ = empty_box;
  double edge_ = 0.0;
  VoxelGrid grid_;
};

// Moves the faces of the box outwards, one after the other, up to `gap` before the bounds of the first triangle in the
// way.
CellBox widened(const CellBox& box, const CellBox& limits, std::span<const CellBox> obstacles, double gap) {
  CellBox wide = box;
  for (int axis = 0; axis < 3; ++axis) {
    CellBox below = wide, above = wide;
    below.min[axis] = limits.min[axis];
    above.max[axis] = limits.max[axis];
    for (const CellBox& obstacle : obstacles) {
      if (overlap(obstacle, below)) below.min[axis] = std::min(obstacle.max[axis] + gap, wide.min[axis]);
      if (overlap(obstacle, above)) above.max[axis] = std::max(obstacle.min[axis] - gap, wide.max[axis]);
    }
    wide.min[axis] = below.min[axis];
    wide.max[axis] = above.max[axis];
  }
  return wide;
}

}  // namespace

InnerBoxes::InnerBoxes(const CellSurface& surface) {
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t)
    largest_motion_ = std::max(largest_motion_, surface.moved(t));
  find_parts(surface);
  const std::vector<std::uint32_t> chosen = parts_worth_a_look(surface);
  std::vector<std::vector<std::uint32_t>> triangles(chosen.size());
  std::vector<std::uint32_t> place_of(parts_.size(), no_id);
  for (std::uint32_t i = 0; i < chosen.size(); ++i) place_of[chosen[i]] = i;
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t)
    if (const std::uint32_t place = place_of[part_of_[t]]; place != no_id) triangles[place].push_back(t);
  for (std::size_t i = 0; i < chosen.size(); ++i) add_boxes(surface, chosen[i], triangles[i]);
}

void InnerBoxes::find_parts(const CellSurface& surface) {
  part_of_.assign(surface.triangle_count(), no_id);
  std::vector<std::uint32_t> stack;
  for (std::uint32_t first = 0; first < surface.triangle_count(); ++first) {
    if (part_of_[first] != no_id) continue;
    const auto part = static_cast<std::uint32_t>(parts_.size());
    parts_.emplace_back();
    part_of_[first] = part;
    stack.push_back(first);
    while (!stack.empty()) {
      const std::uint32_t t = stack.back();
      stack.pop_back();
      for (std::uint32_t edge = 3 * t; edge < 3 * t + 3; ++edge)
        for (std::uint32_t other = surface.beyond(edge); other != edge; other = surface.beyond(other)) {
          if (part_of_[other / 3] != no_id) continue;
          part_of_[other / 3] = part;
          stack.push_back(other / 3);
        }
    }
  }
}

// Returns the parts with the largest bounds, in the order of their numbers.
std::vector<std::uint32_t> InnerBoxes::parts_worth_a_look(const CellSurface& surface) const {
  std::vector<CellBox> bounds(parts_.size(), empty_box);
  std::vector<std::uint32_t> counts(parts_.size(), 0);
  for (std::uint32_t t = 0; t < surface.triangle_count(); ++t) {
    CellBox& box = bounds[part_of_[t]];
    box = unite(box, bounds_of(surface, t));
    ++counts[part_of_[t]];
  }
  std::vector<std::pair<double, std::uint32_t>> sizes;
  for (std::uint32_t p = 0; p < parts_.size(); ++p)
    if (counts[p] >= min_triangles && volume_of(bounds[p]) > 0.0) sizes.emplace_back(-volume_of(bounds[p]), p);
  const auto end = sizes.begin() + static_cast<std::ptrdiff_t>(std::min(sizes.size(), max_parts));
  std::partial_sort(sizes.begin(), end, sizes.end());
  std::vector<std::uint32_t> chosen;
  for (auto it = sizes.begin(); it != end; ++it) chosen.push_back(it->second);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

void InnerBoxes::add_boxes(const CellSurface& surface, std::uint32_t part, std::span<const std::uint32_t> triangles) {
  std::vector<std::uint32_t> borders;
  std::vector<CellBox> obstacles;  // includes regions around borders: a box that touches one cannot be hidden
  obstacles.reserve(triangles.size());
  for (const std::uint32_t t : triangles) {
    obstacles.push_back(bounds_of(surface, t));
    for (std::uint32_t edge = 3 * t; edge < 3 * t + 3; ++edge)
      if (surface.is_border(edge)) borders.push_back(edge);
  }
  if (borders.size() > max_borders) return;
  PartGrid grid(surface, triangles);
  for (const std::uint32_t edge : borders) obstacles.push_back(grown(bounds_of_edge(surface, edge), grid.edge() / 2.0));
  Part& added = parts_[part];
  added.first_box = static_cast<std::uint32_t>(boxes_.size());
  added.first_border = static_cast<std::uint32_t>(borders_.size());
  const double margin = relative_rounding * surface.largest_coordinate();
  double first_volume = 0.0;
  while (added.box_count < max_boxes) {
    const std::optional<CellBox> block = grid.next_box();
    if (!block) break;
    const CellBox box = widened(grown(*block, -margin), grown(grid.bounds(), -margin), obstacles, margin);
    if (glm::any(glm::lessThanEqual(box.max, box.min)) || volume_of(box) < min_share * first_volume) break;
    first_volume = std::max(first_volume, volume_of(box));
    boxes_.push_back(box);
    owners_.push_back(part);
    ++added.box_count;
  }
  if (added.box_count == 0) return;
  added.border_count = static_cast<std::uint32_t>(borders.size());
  borders_.insert(borders_.end(), borders.begin(), borders.end());
}

}  // namespace occlod
