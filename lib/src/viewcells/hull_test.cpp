#include "viewcells/hull_test.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "viewcells/cell_geometry.h"

namespace occlod {
namespace {

// Of coordinates in world space, each a sum of a few products in double precision.
constexpr double relative_rounding = 1e-9;
// Of volumes spanned by differences of coordinates.
constexpr double volume_rounding = 1e-12;

// Floods cost about as much as as many segments.
constexpr std::size_t few_seeds = 2;
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

// Whether the segment from the origin to d meets the triangle; nothing where rounding decides.
std::optional<bool> crosses(const glm::dvec3& d, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const double to_a = glm::length(a), to_b = glm::length(b), to_c = glm::length(c), length = glm::length(d);
  const int ab = sign_of(glm::dot(d, glm::cross(a, b)), length * to_a * to_b);
  const int bc = sign_of(glm::dot(d, glm::cross(b, c)), length * to_b * to_c);
  const int ca = sign_of(glm::dot(d, glm::cross(c, a)), length * to_c * to_a);
  if (std::min({ab, bc, ca}) < 0 && std::max({ab, bc, ca}) > 0) return false;
  if (ab == 0 || bc == 0 || ca == 0) return std::nullopt;
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double size = glm::length(b - a) * glm::length(c - a);
  const int start = sign_of(-glm::dot(normal, a), size * to_a),
            end = sign_of(glm::dot(normal, d - a), size * (to_a + length));
  if (start == 0 || end == 0) return std::nullopt;
  return start != end;
}

}  // namespace

void HullTest::set_cell(const CellBox& cell, double near_reach) {
  cell_ = cell;
  near_reach_ = near_reach;
  first_segment_ = 0;
}

bool HullTest::hides(const CellBox& what, std::uint32_t& blocker) {
  ++counts_.queries;
  if (overlap(cell_, what)) return false;
  rounding_ = relative_rounding *
              std::max({largest_coordinate(cell_), largest_coordinate(what), surface_.largest_coordinate()});
  reached_.clear();
  if (++query_ == 0) {
    table_.assign(table_size, {});
    query_ = 1;
  }
  const Hull hull(cell_, what);
  if (blocker != no_id && flood(hull, what, blocker)) return ++counts_.remembered, true;
  if (!find_seeds(what)) return ++counts_.free, false;
  for (const std::uint32_t seed : seeds_) {
    if (!flood(hull, what, seed)) continue;
    blocker = seed;
    return true;
  }
  return false;
}

// What hides is crossed by every segment, so it will do to begin where one crosses the fewest triangles. False when
// there are none on some segment.
bool HullTest::find_seeds(const CellBox& what) {
  seeds_.clear();
  for (std::size_t i = 0; i < segments.size() && (i == 0 || seeds_.size() > few_seeds); ++i) {
    const std::size_t segment = (first_segment_ + i) % segments.size();
    find_hits(what, segment, i == 0 ? most_seeds : seeds_.size());
    if (hits_.empty()) {
      first_segment_ = segment;
      return false;
    }
    if (i == 0 || hits_.size() < seeds_.size()) seeds_.swap(hits_);
  }
  return true;
}

// Triangles on the segment that may hide, `most` of them or fewer.
void HullTest::find_hits(const CellBox& what, std::size_t segment, std::size_t most) {
  const auto& s = segments[segment];
  const glm::dvec3 from = glm::mix(cell_.min, cell_.max, glm::dvec3(s[0], s[1], s[2]));
  hits_.clear();
  surface_.for_each_hit(from, glm::mix(what.min, what.max, glm::dvec3(s[3], s[4], s[5])), [&](std::uint32_t t) {
    if (!must_avoid(t, what)) hits_.push_back(t);
    return hits_.size() < most;
  });
}

// What hides does not touch the ends of segments.
bool HullTest::must_avoid(std::uint32_t t, const CellBox& what) const {
  const glm::dvec3 &a = surface_.corner(t, 0), &b = surface_.corner(t, 1), &c = surface_.corner(t, 2);
  const double margin = growth(t);
  return triangle_meets(a, b, c, grown(cell_, margin + near_reach_)) || triangle_meets(a, b, c, grown(what, margin));
}

// False where it meets what it must not.
bool HullTest::flood(const Hull& hull, const CellBox& what, std::uint32_t first) {
  first_reached_ = reached_.size();
  if (!reach(first)) return false;
  ++counts_.floods;
  for (std::size_t i = first_reached_; i < reached_.size(); ++i) {
    ++counts_.triangles;
    if (!visit(hull, what, reached_[i])) return false;
  }
  return is_crossed(what);
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
  for (std::uint32_t other = surface_.beyond(edge); other != edge; other = surface_.beyond(other)) {
    const Entry& entry = table_[place_of(other / 3)];
    if (entry.query != query_ || entry.place < first_reached_) return false;
  }
  return true;
}

// Where the triangle is in the table, or would be.
std::size_t HullTest::place_of(std::uint32_t t) const {
  std::size_t place = (t * std::size_t{0x9E3779B1U}) % table_size;
  while (table_[place].query == query_ && table_[place].triangle != t) place = (place + 1) % table_size;
  return place;
}

// False where an earlier flood has been, which did not hide and would have come here as well; and when there are too
// many.
bool HullTest::reach(std::uint32_t t) {
  Entry& entry = table_[place_of(t)];
  if (entry.query == query_) return entry.place >= first_reached_;
  if (reached_.size() == most_triangles) return false;
  entry = {t, query_, static_cast<std::uint32_t>(reached_.size())};
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
  for (std::size_t i = first_reached_; i < reached_.size(); ++i) {
    const std::uint32_t t = reached_[i];
    const auto crossed =
        crosses(to - from, surface_.corner(t, 0) - from, surface_.corner(t, 1) - from, surface_.corner(t, 2) - from);
    if (!crossed) return std::nullopt;
    odd = odd != *crossed;
  }
  return odd;
}

}  // namespace occlod
