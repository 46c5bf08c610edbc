#include "papers/shrunk_occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "papers/projection_point.h"

namespace occlod::paper {
namespace {

constexpr double nothing = std::numeric_limits<double>::infinity();
constexpr double half_width = 4.0 / 3.0;  // of an image at depth 1: more than a face of the cube, for what lies across

struct Shrunk {
  ShadowFrustum frustum;
  ShrinkGoal goal;
};

// The face of a cube in whose direction the occluder is seen from the middle of the cell.
std::size_t face_of(const ConvexOccluder& occluder, const CellBox& cell) {
  glm::dvec3 to(0.0);
  for (const glm::dvec3& p : occluder.corners) to += p - 0.5 * (cell.min + cell.max);
  const glm::dvec3 size = glm::abs(to);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return static_cast<std::size_t>(2 * axis + (to[axis] < 0.0 ? 1 : 0));
}

// Whether directions stay inside the shrunk frustum, which is the cone of all horizon planes moved to its apex.
bool is_inside(const ShadowFrustum& frustum, const glm::dvec3& along) {
  return std::all_of(frustum.horizon.begin(), frustum.horizon.end(),
                     [&](const HalfSpace& space) { return glm::dot(space.normal, along) <= 0.0; });
}

// How far a ray goes until it is behind all faces; infinite if it never is.
double depth_of(const ShadowFrustum& frustum, const glm::dvec3& from, const glm::dvec3& along) {
  double depth = 0.0;
  for (const HalfSpace& face : frustum.behind) {
    const double slope = glm::dot(face.normal, along);
    if (!(slope < 0.0)) return nothing;
    depth = std::max(depth, -face.distance(from) / slope);
  }
  return depth;
}

}  // namespace

ShrunkOcclusion::ShrunkOcclusion(const CellBox& cell, std::span<const ConvexOccluder> occluders, const CellBox& scene,
                                 const ShrunkOptions& options)
    : resolution_(options.resolution) {
  std::array<std::vector<Shrunk>, 6> clusters;
  for (const ConvexOccluder& occluder : occluders) {
    const std::optional<ShadowFrustum> frustum = shadow_frustum(occluder, cell);
    if (!frustum) continue;
    const std::optional<ShrinkGoal> goal = shrink_goal(*frustum, cell, scene);
    if (goal) clusters[face_of(occluder, cell)].push_back({*frustum, *goal});
  }
  for (std::size_t face = 0; face < clusters.size(); ++face) {
    if (clusters[face].empty()) continue;
    Image image;
    const auto axis = static_cast<int>(face / 2);
    image.ahead[axis] = face % 2 == 0 ? 1.0 : -1.0;
    image.right[(axis + 1) % 3] = 1.0;
    image.up[(axis + 2) % 3] = 1.0;
    image.from = 0.5 * (cell.min + cell.max);
    if (options.best_point) {
      std::vector<ShrinkGoal> goals;
      std::vector<HalfSpace> spaces;
      for (const Shrunk& shrunk : clusters[face]) {
        goals.push_back(shrunk.goal);
        spaces.insert(spaces.end(), shrunk.frustum.horizon.begin(), shrunk.frustum.horizon.end());
      }
      image.from = projection_point(goals, spaces, cell);
    }
    const auto side = static_cast<std::size_t>(resolution_);
    image.depths.assign(side * side, nothing);
    for (const Shrunk& shrunk : clusters[face]) draw(image, shrunk.frustum);
    occluders_ += clusters[face].size();
    images_.push_back(std::move(image));
  }
}

void ShrunkOcclusion::draw(Image& image, const ShadowFrustum& frustum) const {
  const auto side = static_cast<std::size_t>(resolution_);
  std::vector<double> above(side + 1), below(side + 1);  // depths at the corners of a row of pixels
  const double step = 2.0 * half_width / resolution_;
  const auto find = [&](std::vector<double>& row, std::size_t y) {
    const glm::dvec3 first =
        image.ahead + (static_cast<double>(y) * step - half_width) * image.up - half_width * image.right;
    const auto along = [&](std::size_t x) { return first + static_cast<double>(x) * step * image.right; };
    // Where the row meets the cone, give or take a corner.
    double low = 0.0, high = static_cast<double>(side);
    for (const HalfSpace& space : frustum.horizon) {
      const double at = glm::dot(space.normal, first), slope = step * glm::dot(space.normal, image.right);
      if (slope > 0.0) high = std::min(high, -at / slope + 1.0);
      if (slope < 0.0) low = std::max(low, -at / slope - 1.0);
    }
    std::fill(row.begin(), row.end(), nothing);
    if (!(low <= high)) return;
    for (auto x = static_cast<std::size_t>(low); x <= static_cast<std::size_t>(high); ++x)
      if (is_inside(frustum, along(x))) row[x] = depth_of(frustum, image.from, along(x));
  };
  find(below, 0);
  for (std::size_t y = 0; y < side; ++y) {
    std::swap(above, below);
    find(below, y + 1);
    double* const row = image.depths.data() + y * side;
    for (std::size_t x = 0; x < side; ++x)
      row[x] = std::min(row[x], std::max({above[x], above[x + 1], below[x], below[x + 1]}));
  }
}

// Whether the box is inside the image, and covered.
bool ShrunkOcclusion::covers(const Image& image, const CellBox& what) const {
  double nearest = nothing, left = nothing, right = -nothing, low = nothing, high = -nothing;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 to = corner(what, i) - image.from;
    const double depth = glm::dot(to, image.ahead);
    if (!(depth > 0.0)) return false;
    nearest = std::min(nearest, depth);
    const double x = glm::dot(to, image.right) / depth, y = glm::dot(to, image.up) / depth;
    left = std::min(left, x);
    right = std::max(right, x);
    low = std::min(low, y);
    high = std::max(high, y);
  }
  if (left < -half_width || low < -half_width || right > half_width || high > half_width) return false;
  const auto pixel = [&](double t) {
    return std::clamp(static_cast<int>((t + half_width) / (2.0 * half_width) * resolution_), 0, resolution_ - 1);
  };
  for (int y = pixel(low); y <= pixel(high); ++y)
    for (int x = pixel(left); x <= pixel(right); ++x)
      if (image.depths[static_cast<std::size_t>(y) * static_cast<std::size_t>(resolution_) +
                       static_cast<std::size_t>(x)] > nearest)
        return false;
  return true;
}

bool ShrunkOcclusion::hides(const Image& image, const CellBox& what, int halvings) const {
  if (covers(image, what)) return true;
  if (halvings == 0) return false;
  const glm::dvec3 size = what.max - what.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  CellBox first = what, second = what;
  first.max[axis] = second.min[axis] = 0.5 * (what.min[axis] + what.max[axis]);
  return hides(image, first, halvings - 1) && hides(image, second, halvings - 1);
}

bool ShrunkOcclusion::hides(const CellBox& what, int halvings) const {
  return std::any_of(images_.begin(), images_.end(), [&](const Image& image) { return hides(image, what, halvings); });
}

}  // namespace occlod::paper
