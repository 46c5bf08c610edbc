#include "papers/cull_map.h"

#include <algorithm>
#include <limits>

namespace occlod::paper {

constexpr double nothing = -std::numeric_limits<double>::infinity();

CullMap::CullMap(const CellBox& scene, int pixels)
    : scene_(scene),
      pixels_(pixels),
      heights_(static_cast<std::size_t>(pixels) * static_cast<std::size_t>(pixels), nothing) {}

// Up to where the frustum goes above (x, y), if it begins at the ground.
double CullMap::height(const ShadowFrustum& frustum, double x, double y) const {
  double low = nothing, high = std::numeric_limits<double>::infinity();
  for (const auto* const spaces : {&frustum.horizon, &frustum.behind})
    for (const HalfSpace& space : *spaces) {
      const double left = space.offset - space.normal.x * x - space.normal.y * y;  // >= normal.z * z
      if (space.normal.z > 0.0) {
        high = std::min(high, left / space.normal.z);
      } else if (space.normal.z < 0.0) {
        low = std::max(low, left / space.normal.z);
      } else if (left < 0.0) {
        return nothing;
      }
    }
  return low <= scene_.min.z ? high : nothing;
}

void CullMap::add(const ShadowFrustum& frustum) {
  const glm::dvec3 step = (scene_.max - scene_.min) / static_cast<double>(pixels_);
  const auto width = static_cast<std::size_t>(pixels_);
  std::vector<double> above(width + 1), below(width + 1);
  const auto find = [&](std::vector<double>& row, int y) {
    for (std::size_t x = 0; x <= width; ++x)
      row[x] = height(frustum, scene_.min.x + static_cast<double>(x) * step.x, scene_.min.y + y * step.y);
  };
  find(below, 0);
  for (int y = 0; y < pixels_; ++y) {
    std::swap(above, below);
    find(below, y + 1);
    double* const row = heights_.data() + static_cast<std::size_t>(y) * width;
    for (std::size_t x = 0; x < width; ++x)
      row[x] = std::max(row[x], std::min({above[x], above[x + 1], below[x], below[x + 1]}));
  }
}

bool CullMap::hides(const CellBox& what) const {
  if (what.min.z < scene_.min.z) return false;
  const glm::dvec3 low = (what.min - scene_.min) / (scene_.max - scene_.min) * static_cast<double>(pixels_);
  const glm::dvec3 high = (what.max - scene_.min) / (scene_.max - scene_.min) * static_cast<double>(pixels_);
  if (low.x < 0.0 || low.y < 0.0 || high.x >= pixels_ || high.y >= pixels_) return false;
  for (auto y = static_cast<int>(low.y); y <= static_cast<int>(high.y); ++y)
    for (auto x = static_cast<int>(low.x); x <= static_cast<int>(high.x); ++x)
      if (heights_[static_cast<std::size_t>(y) * static_cast<std::size_t>(pixels_) + static_cast<std::size_t>(x)] <
          what.max.z)
        return false;
  return true;
}

}  // namespace occlod::paper
