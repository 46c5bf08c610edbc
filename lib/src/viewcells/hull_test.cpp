#include "viewcells/hull_test.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "viewcells/cell_geometry.h"

namespace occlod {
namespace {

// Of coordinates in world space, each a sum of a few products in double precision.
constexpr double relative_rounding = 1e-9;
// Of volumes spanned by differences of coordinates.
constexpr double volume_rounding = 1e-12;

// Where a segment meets more, those near the cell hide most.
constexpr std::size_t most_seeds = 16;

// Where segments begin in the cell and end in the box: shares of both. The next is tried where one comes too close to
// an edge to tell on which side it passes.
constexpr std::array<std::array<double, 6>, 8> segments = {{{0.5, 0.5, 0.5, 0.5, 0.5, 0.5},
                                                            {0.37, 0.61, 0.43, 0.58, 0.41, 0.55},
                                                            {0.71, 0.29, 0.64, 0.33, 0.69, 0.38},
                                                            {0.23, 0.47, 0.81, 0.76, 0.24, 0.66},
                                                            {0.86, 0.83, 0.19, 0.11, 0.87, 0.14},
                                                            {0.13, 0.17, 0.27, 0.91, 0.79, 0.93},
                                                            {0.54, 0.93, 0.72, 0.27, 0.09, 0.47},
                                                            {0.94, 0.07, 0.57, 0.46, 0.51, 0.81}}};

// 1, -1, or 0 where rounding decides.
int sign_of(double volume, double size) {
  return std::abs(volume) <= volume_rounding * size ? 0 : volume > 0.0 ? 1 : -1;
}

// The sign of x.cross(y, z), or 0 where rounding decides.
int turn_of(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z) {
  const double volume = glm::dot(x, glm::cross(y, z));
  // Squares, so that no root is taken.
  if (volume * volume <= volume_rounding * volume_rounding * glm::dot(x, x) * glm::dot(y, y) * glm::dot(z, z)) return 0;
  return volume > 0.0 ? 1 : -1;
}

// Whether the segment from the origin to d meets the triangle; nothing where rounding decides.
std::optional<bool> crosses(const glm::dvec3& d, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const int ab = turn_of(d, a, b), bc = turn_of(d, b, c);
  if (ab * bc < 0) return false;
  const int ca = turn_of(d, c, a);
  if (ab * ca < 0 || bc * ca < 0) return false;
  if (ab == 0 || bc == 0 || ca == 0) return std::nullopt;
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double size = glm::length(b - a) * glm::length(c - a), to_a = glm::length(a);
  const int start = sign_of(-glm::dot(normal, a), size * to_a),
            end = sign_of(glm::dot(normal, d - a), size * (to_a + glm::length(d)));
  if (start == 0 || end == 0) return std::nullopt;
  return start != end;
}

}  // namespace

HullTest::HullTest(const CellSurface& surface)
    : surface_(surface), hid_(memory_size, no_id), reached_by_(zeroed_array<std::uint32_t>(surface.triangle_count())) {}

void HullTest::set_cell(const CellBox& cell, double near_reach) {
  cell_ = cell;
  near_reach_ = near_reach;
  first_segment_ = 0;
  std::fill(hid_.begin(), hid_.end(), no_id);
}

bool HullTest::hides(const CellBox& what) {
  ++counts_.queries;
  if (overlap(cell_, what)) return false;
  rounding_ = relative_rounding *
              std::max({largest_coordinate(cell_), largest_coordinate(what), surface_.largest_coordinate()});
  begin_floods();
  find_hits(what, first_segment_, most_seeds, seeds_);
  if (seeds_.empty()) return ++counts_.free, false;
  const Hull hull(cell_, what);
  const auto others =
      std::stable_partition(seeds_.begin(), seeds_.end(), [&](std::uint32_t t) { return has_hidden(t); });
  if (flood_any(hull, what, {seeds_.begin(), others})) return ++counts_.remembered, true;
  if (is_free(what)) return ++counts_.free, false;
  return flood_any(hull, what, {others, seeds_.end()});
}

void HullTest::begin_floods() {
  // A query makes one flood a seed at most. Before their numbers run out they begin anew.
  if (flood_ > std::numeric_limits<std::uint32_t>::max() - most_seeds) {
    std::fill_n(reached_by_.get(), surface_.triangle_count(), 0U);
    flood_ = 0;
  }
  first_flood_ = flood_ + 1;
  reached_count_ = 0;
}

// Triangles on the segment that may hide, `most` of them or fewer, roughly from the cell to the box.
void HullTest::find_hits(const CellBox& what, std::size_t segment, std::size_t most,
                         std::vector<std::uint32_t>& hits) const {
  const auto& s = segments[segment];
  const glm::dvec3 from = glm::mix(cell_.min, cell_.max, glm::dvec3(s[0], s[1], s[2]));
  hits.clear();
  surface_.for_each_hit(from, glm::mix(what.min, what.max, glm::dvec3(s[3], s[4], s[5])), [&](std::uint32_t t) {
    if (!must_avoid(t, what)) hits.push_back(t);
    return hits.size() < most;
  });
}

// Whether there is nothing on some other segment that may hide.
bool HullTest::is_free(const CellBox& what) {
  for (std::size_t i = 1; i < segments.size(); ++i) {
    const std::size_t segment = (first_segment_ + i) % segments.size();
    find_hits(what, segment, 1, hits_);
    if (!hits_.empty()) continue;
    first_segment_ = segment;
    return true;
  }
  return false;
}

// What hides does not touch the ends of segments.
bool HullTest::must_avoid(std::uint32_t t, const CellBox& what) const {
  const glm::dvec3 &a = surface_.corner(t, 0), &b = surface_.corner(t, 1), &c = surface_.corner(t, 2);
  const double margin = growth(t);
  return triangle_meets(a, b, c, grown(cell_, margin + near_reach_)) || triangle_meets(a, b, c, grown(what, margin));
}

bool HullTest::flood_any(const Hull& hull, const CellBox& what, std::span<const std::uint32_t> seeds) {
  return std::any_of(seeds.begin(), seeds.end(), [&](std::uint32_t seed) { return flood(hull, what, seed); });
}

// False where it meets what it must not.
bool HullTest::flood(const Hull& hull, const CellBox& what, std::uint32_t first) {
  reached_.clear();
  ++flood_;
  if (!reach(first)) return false;
  ++counts_.floods;
  std::size_t visited = 0;  // more are reached on the way
  while (visited < reached_.size()) {
    ++counts_.triangles;
    if (!visit(hull, what, reached_[visited++])) return false;
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

// Whether this flood has reached all triangles beyond the edge.
bool HullTest::is_crossed_already(std::uint32_t edge) const {
  for (std::uint32_t other = surface_.beyond(edge); other != edge; other = surface_.beyond(other))
    if (reached_by_[other / 3] != flood_) return false;
  return true;
}

// False where an earlier flood of this query has been, which did not hide and would have come here as well; and when
// there are too many.
bool HullTest::reach(std::uint32_t t) {
  if (reached_by_[t] >= first_flood_) return reached_by_[t] == flood_;
  if (reached_count_ == most_triangles) return false;
  ++reached_count_;
  reached_by_[t] = flood_;
  reached_.push_back(t);
  return true;
}

bool HullTest::is_crossed(const CellBox& what) const {
  for (const auto& s : segments) {
    const glm::dvec3 from = glm::mix(cell_.min, cell_.max, glm::dvec3(s[0], s[1], s[2]));
    const glm::dvec3 to = glm::mix(what.min, what.max, glm::dvec3(s[3], s[4], s[5]));
    if (const auto crossed = is_crossed(from, to)) return *crossed;
  }
  return false;
}

// An odd number of times.
std::optional<bool> HullTest::is_crossed(const glm::dvec3& from, const glm::dvec3& to) const {
  bool odd = false;
  for (const std::uint32_t t : reached_) {
    const auto crossed =
        crosses(to - from, surface_.corner(t, 0) - from, surface_.corner(t, 1) - from, surface_.corner(t, 2) - from);
    if (!crossed) return std::nullopt;
    odd = odd != *crossed;
  }
  return odd;
}

}  // namespace occlod
