#include "cells/hull_test.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <optional>

#include "cells/cell_geometry.h"
#include "cells/hull.h"

namespace occlod {
namespace {

// Relative rounding error of world-space coordinates, each a sum of a few products in double precision.
constexpr double relative_rounding = 1e-9;

// Returns whether the segment meets the box, up to rounding.
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

// Returns whether all segments from the cell to `what` meet the box. As seen from a point, the region in or behind a
// convex set is convex, so a box is entirely inside it if its corners are. The same holds in the other direction.
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

// Runs the hull test of the whole part.
InnerBoxTest::State InnerBoxTest::find_state(std::uint32_t box) const {
  const CellBox& what = boxes_.boxes()[box];
  const std::uint32_t part = boxes_.owner(box);
  const double rounding = relative_rounding * std::max(largest_coordinate(cell_), surface_.largest_coordinate());
  const Hull hull(cell_, what);
  for (const std::uint32_t edge : boxes_.borders(boxes_.part(part))) {
    const std::uint32_t t = edge / 3;
    const auto k = static_cast<int>(edge % 3);
    // Other triangles between the same corners are in the list as well, with their own motion.
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
  if (remembered_.size() == max_remembered) remembered_.pop_back();
  remembered_.insert(remembered_.begin(), box);
}

namespace {

// Where a segment meets more triangles, those near the cell hide most.
constexpr std::size_t max_seeds = 64;
// Segments that must all be blocked before floods begin: that of the middles and those of the corners. The other inner
// ones are seldom free where these are not.
constexpr std::size_t tested_segments = 1 + outer_segments;

CellSegment tested_segment(const CellBox& cell, const CellBox& what, std::size_t i) {
  return segment_between(cell, what, i == 0 ? 0 : inner_segments + i - 1);
}

}  // namespace

HullTest::HullTest(const CellSurface& surface, const InnerBoxes* boxes)
    : surface_(surface), hid_(memory_size, no_id), reached_by_(zeroed_array<std::uint32_t>(surface.triangle_count())) {
  if (boxes != nullptr) boxes_.emplace(surface, *boxes);
  parts_ = boxes;
}

void HullTest::set_cell(const CellBox& cell, double near_reach) {
  cell_ = cell;
  near_reach_ = near_reach;
  first_segment_ = 0;
  std::fill(hid_.begin(), hid_.end(), no_id);
  blockers_.fill(no_id);
  if (boxes_) boxes_->set_cell(cell, near_reach);
}

bool HullTest::hides(const CellBox& what) {
  ++counts_.queries;
  if (overlap(cell_, what)) return false;
  rounding_ = relative_rounding *
              std::max({largest_coordinate(cell_), largest_coordinate(what), surface_.largest_coordinate()});
  if (boxes_ && boxes_->hides_again(what)) return ++counts_.boxed, true;
  find_hits(what, first_segment_, max_seeds, seeds_);
  if (seeds_.empty()) return ++counts_.free, false;
  if (boxes_ && is_boxed(what)) return ++counts_.boxed, true;
  if (is_free(what)) return ++counts_.free, false;
  begin_floods();
  find_crossings(what);
  const Hull hull(cell_, what);
  const auto others =
      std::stable_partition(seeds_.begin(), seeds_.end(), [&](std::uint32_t t) { return has_hidden(t); });
  if (flood_any(hull, what, {seeds_.begin(), others})) return ++counts_.remembered, true;
  return flood_any(hull, what, {others, seeds_.end()});
}

void HullTest::begin_floods() {
  // A query starts at most one flood per seed. Restart the numbering before it overflows.
  if (flood_ > std::numeric_limits<std::uint32_t>::max() - max_seeds) {
    std::fill_n(reached_by_.get(), surface_.triangle_count(), 0U);
    flood_ = 0;
  }
  first_flood_ = flood_ + 1;
  reached_count_ = 0;
}

// Finds at most `most` triangles on the segment that may hide the box, roughly in order from the cell to the box.
void HullTest::find_hits(const CellBox& what, std::size_t segment, std::size_t most,
                         std::vector<std::uint32_t>& hits) const {
  const CellSegment s = tested_segment(cell_, what, segment);
  hits.clear();
  surface_.for_each_hit(s.from, s.to, [&](std::uint32_t t) {
    if (!must_avoid(t, what)) hits.push_back(t);
    return hits.size() < most;
  });
}

// Returns whether a box inside one of the parts that the first segment meets hides `what`.
bool HullTest::is_boxed(const CellBox& what) {
  std::uint32_t last = no_id;
  for (const std::uint32_t t : seeds_) {
    const std::uint32_t part = parts_->part_of(t);
    if (part != last && boxes_->hides(what, part)) return true;
    last = part;
  }
  return false;
}

// Returns whether some other tested segment meets nothing that may hide the box.
bool HullTest::is_free(const CellBox& what) {
  for (std::size_t i = 1; i < tested_segments; ++i) {
    const std::size_t segment = (first_segment_ + i) % tested_segments;
    if (is_blocked(what, segment)) continue;
    first_segment_ = segment;
    return true;
  }
  return false;
}

// Tests the triangle that blocked this segment for another box first, because it often does so again.
bool HullTest::is_blocked(const CellBox& what, std::size_t segment) {
  const CellSegment s = tested_segment(cell_, what, segment);
  std::uint32_t& blocker = blockers_[segment];
  if (blocker != no_id && surface_.meets(blocker, s.from, s.to) && !must_avoid(blocker, what)) return true;
  find_hits(what, segment, 1, hits_);
  if (hits_.empty()) return false;
  blocker = hits_.front();
  return true;
}

// Returns whether the triangle must not be used, because an occluder must not touch the ends of segments.
bool HullTest::must_avoid(std::uint32_t t, const CellBox& what) const {
  const glm::dvec3 &a = surface_.corner(t, 0), &b = surface_.corner(t, 1), &c = surface_.corner(t, 2);
  const double margin = growth(t);
  return triangle_meets(a, b, c, grown(cell_, margin + near_reach_)) || triangle_meets(a, b, c, grown(what, margin));
}

bool HullTest::flood_any(const Hull& hull, const CellBox& what, std::span<const std::uint32_t> seeds) {
  return std::any_of(seeds.begin(), seeds.end(), [&](std::uint32_t seed) { return flood(hull, what, seed); });
}

void HullTest::find_crossings(const CellBox& what) {
  crossings_.clear();
  if (parts_ == nullptr || seeds_.size() == max_seeds) return;
  const CellSegment segment = tested_segment(cell_, what, first_segment_);
  for (const std::uint32_t t : seeds_) {
    const auto crossed = crosses(segment, surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2));
    if (!crossed) return crossings_.clear();
    if (*crossed) crossings_.push_back(t);
  }
}

void HullTest::aim(const CellBox& what, std::uint32_t first) {
  left_.clear();
  is_even_ = false;
  goal_ = 0.5 * (what.min + what.max);
  if (crossings_.empty()) return;
  const std::uint32_t part = parts_->part_of(first);
  std::copy_if(crossings_.begin(), crossings_.end(), std::back_inserter(left_),
               [&](std::uint32_t t) { return parts_->part_of(t) == part; });
  is_even_ = !left_.empty() && left_.size() % 2 == 0;
}

std::uint32_t HullTest::next_to_visit() {
  std::pop_heap(waiting_.begin(), waiting_.end());
  const std::uint32_t t = waiting_.back().triangle;
  waiting_.pop_back();
  return t;
}

// Floods from a triangle; returns false where the flood meets a triangle that must not be used.
bool HullTest::flood(const Hull& hull, const CellBox& what, std::uint32_t first) {
  reached_.clear();
  waiting_.clear();
  ++flood_;
  aim(what, first);
  if (!reach(first)) return false;
  ++counts_.floods;
  while (!waiting_.empty()) {
    ++counts_.triangles;
    if (!visit(hull, what, next_to_visit())) return false;
    if (is_even_ && left_.empty()) return false;
  }
  if (!is_crossed(what)) return false;
  for (const std::uint32_t t : reached_) hid_[memory_place(t)] = t;
  return true;
}

bool HullTest::visit(const Hull& hull, const CellBox& what, std::uint32_t t) {
  if (must_avoid(t, what)) return false;
  const double margin = growth(t);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t edge = 3 * t + k;
    if (!surface_.is_border(edge) && is_crossed_already(edge)) continue;
    double largest = margin;
    for (std::uint32_t other = surface_.beyond(edge); other != edge; other = surface_.beyond(other))
      largest = std::max(largest, growth(other / 3));
    if (!hull.may_meet(surface_.corner(t, static_cast<int>(k)),
                       surface_.corner(t, k == 2 ? 0 : static_cast<int>(k) + 1), largest))
      continue;
    if (surface_.is_border(edge)) return false;
    for (std::uint32_t other = surface_.beyond(edge); other != edge; other = surface_.beyond(other))
      if (!reach(other / 3)) return false;
  }
  return true;
}

// Returns whether this flood has reached all triangles beyond the edge.
bool HullTest::is_crossed_already(std::uint32_t edge) const {
  for (std::uint32_t other = surface_.beyond(edge); other != edge; other = surface_.beyond(other))
    if (reached_by_[other / 3] != flood_) return false;
  return true;
}

// Adds a triangle to the flood. Returns false where an earlier flood of this query has been, because that flood did not
// hide the box and would have come here as well; also when there are too many triangles.
bool HullTest::reach(std::uint32_t t) {
  if (reached_by_[t] >= first_flood_) return reached_by_[t] == flood_;
  if (reached_count_ == max_triangles) return false;
  ++reached_count_;
  reached_by_[t] = flood_;
  reached_.push_back(t);
  if (is_even_) {
    std::erase(left_, t);
    if (!left_.empty()) goal_ = surface_.corner(left_.front(), 0);
  }
  const glm::dvec3 way = surface_.corner(t, 0) - goal_;
  waiting_.push_back({glm::dot(way, way), t});
  std::push_heap(waiting_.begin(), waiting_.end());
  return true;
}

bool HullTest::is_crossed(const CellBox& what) const {
  for (std::size_t i = 0; i < inner_segments; ++i)
    if (const auto crossed = is_crossed(segment_between(cell_, what, i))) return *crossed;
  return false;
}

// Returns whether the flood crosses the segment an odd number of times.
std::optional<bool> HullTest::is_crossed(const CellSegment& segment) const {
  bool odd = false;
  for (const std::uint32_t t : reached_) {
    const auto crossed = crosses(segment, surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2));
    if (!crossed) return std::nullopt;
    odd = odd != *crossed;
  }
  return odd;
}

}  // namespace occlod
