#include "cells/inner_box_test.h"

#include <algorithm>
#include <glm/common.hpp>
#include <optional>

#include "cells/cell_geometry.h"
#include "cells/cell_segment.h"
#include "cells/hull.h"

namespace occlod {
namespace {

// Of coordinates in world space.
constexpr double relative_rounding = 1e-9;

// Whether the segment meets the box, up to rounding.
bool meets(const glm::dvec3& from, const glm::dvec3& to, const CellBox& box) {
  double first = 0.0, last = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = to[axis] - from[axis];
    if (along == 0.0) {
      if (from[axis] < box.min[axis] || from[axis] > box.max[axis]) return false;
      continue;
    }
    const double a = (box.min[axis] - from[axis]) / along, b = (box.max[axis] - from[axis]) / along;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last;
}

}  // namespace

InnerBoxTest::InnerBoxTest(const CellSurface& surface, const InnerBoxes& boxes)
    : surface_(surface), boxes_(boxes), at_cell_(boxes.part_count(), false) {}

void InnerBoxTest::set_cell(const CellBox& cell, double near_reach) {
  cell_ = cell;
  near_reach_ = near_reach;
  states_.assign(boxes_.boxes().size(), State::unknown);
  remembered_.clear();
  find_parts_at_cell();
}

void InnerBoxTest::find_parts_at_cell() {
  at_cell_.assign(boxes_.part_count(), false);
  const double rounding = relative_rounding * std::max(largest_coordinate(cell_), surface_.largest_coordinate());
  const CellBox reach = grown(cell_, near_reach_ + boxes_.largest_motion() + rounding);
  surface_.bvh().for_each_group(
      cell_.min, 1, [&](const TriangleBvh::Group& group) { return overlap(group.box, reach); },
      [&](const TriangleBvh::Group& group) {
        for (std::uint32_t t = group.first; t < group.first + group.count; ++t)
          if (triangle_meets(surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2),
                             grown(cell_, near_reach_ + surface_.moved(t) + rounding)))
            at_cell_[boxes_.part_of(t)] = true;
      });
}

bool InnerBoxTest::hides_again(const CellBox& what) {
  const auto it = std::find_if(remembered_.begin(), remembered_.end(),
                               [&](std::uint32_t box) { return is_between(what, boxes_.boxes()[box]); });
  if (it == remembered_.end()) return false;
  std::rotate(remembered_.begin(), it, it + 1);
  return true;
}

bool InnerBoxTest::hides(const CellBox& what, std::uint32_t part) {
  if (at_cell_[part]) return false;
  const InnerBoxes::Part& p = boxes_.part(part);
  for (std::uint32_t box = p.first_box; box < p.first_box + p.box_count; ++box) {
    if (!is_between(what, boxes_.boxes()[box]) || !is_hidden(box)) continue;
    remember(box);
    return true;
  }
  return false;
}

// Whether all segments from the cell to `what` meet the box. From a point, what lies in or behind a convex set is
// convex; so all of a box does if its corners do. The same holds the other way round.
bool InnerBoxTest::is_between(const CellBox& what, const CellBox& box) const {
  const double rounding = relative_rounding * std::max(largest_coordinate(cell_), largest_coordinate(what));
  const CellBox inner = grown(box, -rounding);
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t j = 0; j < 8; ++j)
      if (!meets(corner_of(cell_, j), corner_of(what, i ^ j), inner)) return false;
  return true;
}

bool InnerBoxTest::is_hidden(std::uint32_t box) {
  if (states_[box] == State::unknown) states_[box] = find_state(box);
  return states_[box] == State::hidden;
}

// The hull test of the whole part.
InnerBoxTest::State InnerBoxTest::find_state(std::uint32_t box) const {
  const CellBox& what = boxes_.boxes()[box];
  const std::uint32_t part = boxes_.owner(box);
  const double rounding = relative_rounding * std::max(largest_coordinate(cell_), surface_.largest_coordinate());
  const Hull hull(cell_, what);
  for (const std::uint32_t edge : boxes_.borders(boxes_.part(part))) {
    const std::uint32_t t = edge / 3;
    const auto k = static_cast<int>(edge % 3);
    // The motion of others between the same corners is in the list as well.
    if (hull.may_meet(surface_.corner(t, k), surface_.corner(t, k == 2 ? 0 : k + 1), surface_.moved(t) + rounding))
      return State::seen;
  }
  for (std::size_t i = 1; i < inner_segments; ++i) {
    const CellSegment segment = segment_between(cell_, what, i);
    std::optional<bool> odd = false;
    surface_.bvh().for_each_near(segment.from, segment.to, [&](std::uint32_t t) {
      if (boxes_.part_of(t) != part) return true;
      const auto crossed = crosses(segment, surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2));
      if (crossed)
        odd = *odd != *crossed;
      else
        odd.reset();
      return odd.has_value();
    });
    if (odd) return *odd ? State::hidden : State::seen;
  }
  return State::seen;
}

void InnerBoxTest::remember(std::uint32_t box) {
  if (remembered_.size() == most_remembered) remembered_.pop_back();
  remembered_.insert(remembered_.begin(), box);
}

}  // namespace occlod
