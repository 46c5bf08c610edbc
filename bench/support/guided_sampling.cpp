#include "support/guided_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "support/cpu_clock.h"

namespace occlod::bench {
namespace {

constexpr std::uint64_t clock_rays = 256;

// The border of the triangle, moved outwards in its plane by a distance for each corner: each corner becomes three
// points. False for triangles without an area.
bool enlarge(const std::array<glm::vec3, 3>& corners, const std::array<float, 3>& by, std::array<glm::vec3, 9>& out) {
  const glm::vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const float size = glm::length(normal);
  if (!(size > 0.0F)) return false;
  std::array<glm::vec3, 3> outwards;  // of the edge from corner k to the next
  for (std::size_t k = 0; k < 3; ++k)
    outwards[k] = glm::normalize(glm::cross(corners[(k + 1) % 3] - corners[k], normal / size));
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3 before = outwards[(k + 2) % 3], after = outwards[k];
    out[3 * k] = corners[k] + by[k] * before;
    out[3 * k + 1] = corners[k] + by[k] * glm::normalize(before + after);
    out[3 * k + 2] = corners[k] + by[k] * after;
  }
  return true;
}

// Where the line p + t d enters the box: false where it misses it or the box is not at t > 0.
bool enters(const glm::vec3& low, const glm::vec3& high, const glm::vec3& p, const glm::vec3& d, float& t) {
  float first = 0.0F, last = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0.0F) {
      if (p[axis] < low[axis] || p[axis] > high[axis]) return false;
      continue;
    }
    const float a = (low[axis] - p[axis]) / d[axis], b = (high[axis] - p[axis]) / d[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  t = first;
  return first <= last && first > 0.0F;
}

}  // namespace

GuidedSampling::GuidedSampling(std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                               const test::RayScene& scene, const CellBox& cell, const GuidedOptions& options)
    : positions_(positions),
      triangles_(triangles),
      scene_(scene),
      low_(cell.min),
      high_(cell.max),
      options_(options),
      random_(options.seed),
      is_found_(triangles.size(), false) {}

std::span<const FoundTriangle> GuidedSampling::run() {
  start_ms_ = thread_cpu_ms();
  ms_ = 0.0;
  while (ms_ < options_.max_ms && rays_ < options_.max_rays) {
    if (queue_.empty() || !options_.guided) {
      shoot_at_random();
      continue;
    }
    const Sample sample = queue_.front();
    queue_.pop_front();
    sample_border(sample);
  }
  read_clock();
  return found_;
}

void GuidedSampling::read_clock() {
  ms_ = thread_cpu_ms() - start_ms_;
  for (; timed_ < found_.size(); ++timed_) found_[timed_].ms = ms_;
}

GuidedSampling::Hit GuidedSampling::shoot(const glm::vec3& start, const glm::vec3& towards) {
  const Hit hit = scene_.first_triangle(start, towards - start);
  if (++rays_ % clock_rays == 0) read_clock();
  if (hit.triangle == no_id || is_found_[hit.triangle]) return hit;
  is_found_[hit.triangle] = true;
  found_.push_back({hit.triangle, rays_});
  if (options_.guided) queue_.push_back({start, start + hit.t * (towards - start), hit.triangle});
  return hit;
}

// Lines through the cell, all equally likely: from a point of its surface, with the cosine to the normal as density.
void GuidedSampling::shoot_at_random() {
  const glm::dvec3 size(high_ - low_), areas(size.y * size.z, size.z * size.x, size.x * size.y);
  double pick = random_.between(0.0, areas.x + areas.y + areas.z);
  int axis = 0;
  for (; axis < 2 && pick >= areas[axis]; ++axis) pick -= areas[axis];
  const bool is_high = random_.below(2) == 1;
  glm::vec3 start, direction;
  for (int k = 0; k < 3; ++k) start[k] = low_[k] + static_cast<float>(random_.between(0.0, 1.0) * size[k]);
  start[axis] = is_high ? high_[axis] : low_[axis];
  double x = 1.0, y = 1.0;
  while (x * x + y * y >= 1.0) {
    x = random_.between(-1.0, 1.0);
    y = random_.between(-1.0, 1.0);
  }
  direction[(axis + 1) % 3] = static_cast<float>(x);
  direction[(axis + 2) % 3] = static_cast<float>(y);
  direction[axis] = static_cast<float>((is_high ? 1.0 : -1.0) * std::sqrt(1.0 - x * x - y * y));
  shoot(start, start + direction);
}

// Adaptive border sampling: what lies beyond the border of a triangle, seen from where it was found.
void GuidedSampling::sample_border(const Sample& sample) {
  const Triangle& t = triangles_[sample.triangle];
  const std::array corners{positions_[t.x], positions_[t.y], positions_[t.z]};
  std::array<float, 3> by{};
  for (std::size_t k = 0; k < 3; ++k)
    by[k] = static_cast<float>(options_.border_rad) * glm::distance(corners[k], sample.start);
  std::array<glm::vec3, 9> places;
  if (!enlarge(corners, by, places)) return;
  std::array<BorderPoint, 9> border;
  for (std::size_t k = 0; k < 9; ++k) border[k] = look_at(sample, places[k]);
  for (std::size_t k = 0; k < 9; ++k) divide(sample, border[k], border[(k + 1) % 9]);
}

GuidedSampling::BorderPoint GuidedSampling::look_at(const Sample& sample, const glm::vec3& place) {
  const Hit hit = shoot(sample.start, place);
  if (hit.triangle != no_id && hit.triangle != sample.triangle && hit.t < 1.0F - static_cast<float>(options_.jump))
    look_past(sample, place, hit.triangle);
  return {place, hit};
}

// Between points that show different triangles there is more to be found.
void GuidedSampling::divide(const Sample& sample, const BorderPoint& a, const BorderPoint& b) {
  if (a.hit.triangle == b.hit.triangle) return;
  const glm::vec3 to_a = a.place - sample.start, to_b = b.place - sample.start;
  const float across = glm::length(glm::cross(to_a, to_b)), finest = static_cast<float>(options_.finest_rad);
  if (glm::dot(to_a, to_b) > 0.0F && across < finest * glm::length(to_a) * glm::length(to_b)) return;
  const BorderPoint middle = look_at(sample, 0.5F * (a.place + b.place));
  divide(sample, a, middle);
  divide(sample, middle, b);
}

// Reverse sampling: `hidden`, on the border, is behind the occluder. In the plane of the ray to it and of the ray that
// found the triangle the occluder is a segment: lines from `hidden` past its ends may reach the cell elsewhere.
void GuidedSampling::look_past(const Sample& sample, const glm::vec3& hidden, std::uint32_t occluder) {
  const glm::vec3 normal = glm::cross(hidden - sample.start, sample.point - sample.start);
  const Triangle& t = triangles_[occluder];
  std::array<float, 3> side{};
  for (int k = 0; k < 3; ++k) side[static_cast<std::size_t>(k)] = glm::dot(normal, positions_[t[k]] - sample.start);
  std::array<glm::vec3, 2> ends{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < 3 && count < 2; ++k) {
    const std::size_t next = (k + 1) % 3;
    if ((side[k] < 0.0F) == (side[next] < 0.0F)) continue;
    const glm::vec3 a = positions_[t[static_cast<int>(k)]], b = positions_[t[static_cast<int>(next)]];
    ends[count++] = glm::mix(a, b, side[k] / (side[k] - side[next]));
  }
  const glm::vec3 along = ends[1] - ends[0];
  if (count < 2 || !(glm::length(along) > 0.0F)) return;
  const auto margin = static_cast<float>(options_.border_rad);
  const glm::vec3 step = margin * glm::distance(ends[0], sample.start) * glm::normalize(along);
  look_back(hidden, ends[0] - step);
  look_back(hidden, ends[1] + step);
}

void GuidedSampling::look_back(const glm::vec3& hidden, const glm::vec3& past) {
  float t = 0.0F;
  if (!enters(low_, high_, hidden, past - hidden, t)) return;
  shoot(glm::clamp(hidden + t * (past - hidden), low_, high_), hidden);
}

}  // namespace occlod::bench
