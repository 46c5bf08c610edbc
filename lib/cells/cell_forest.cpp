#include "cells/cell_forest.h"

#include <utility>
#include <vector>

namespace occlod {
namespace {

constexpr unsigned regions_level = 22;  // above blocks of 2^21 root cells to every side

// Whether two root cells are in one block of 2^level to every side.
bool together(const RootCell& a, const RootCell& b, unsigned level) {
  if (level >= regions_level) return true;
  bool same = a.region == b.region;
  for (std::size_t axis = 0; axis < 3; ++axis) same = same && a.place[axis] >> level == b.place[axis] >> level;
  return same;
}

// Of roots [first, end), which are together at this level.
CellSubtree join_block(std::span<const RootCell> roots, std::size_t first, std::size_t end, unsigned level,
                       const std::function<CellSubtree(std::size_t)>& take) {
  if (end - first == 1) return take(first);
  std::vector<CellSubtree> parts;
  for (std::size_t begin = first; begin < end;) {
    std::size_t next = begin + 1;
    while (next < end && together(roots[begin], roots[next], level - 1)) ++next;
    parts.push_back(join_block(roots, begin, next, level - 1, take));
    begin = next;
  }
  return parts.size() == 1 ? std::move(parts.front()) : join(std::move(parts));
}

}  // namespace

CellSubtree join_roots(std::span<const RootCell> roots, const std::function<CellSubtree(std::size_t)>& take) {
  return join_block(roots, 0, roots.size(), regions_level, take);
}

}  // namespace occlod
