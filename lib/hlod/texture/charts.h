// Finds the charts of a mesh: connected groups of triangles in the plane of an image, and the texels that they touch.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/fwd.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <span>
#include <vector>

#include "occlod/base.h"
#include "occlod/mesh.h"

namespace occlod::tiles {

// Describes a connected group of triangles with one image. Coordinates are texels of the image, v downwards.
struct Chart {
  std::uint32_t image = no_id;
  glm::dvec2 min{std::numeric_limits<double>::infinity()};
  glm::dvec2 max{-std::numeric_limits<double>::infinity()};
  double texels = 0.0;                   // area of the triangles in the image
  double area = 0.0;                     // of the triangles in space, square object units
  std::vector<std::uint32_t> triangles;  // of the mesh, ascending

  // Returns the first texel that the chart touches, and how many from there, in an image of another scale.
  [[nodiscard]] glm::i64vec2 first_texel(double scale = 1.0) const noexcept;
  [[nodiscard]] glm::i64vec2 texel_counts(double scale = 1.0) const noexcept;
  // Returns the size of a texel of the image, object units; infinite where the chart has no area in the image.
  [[nodiscard]] double texel_size() const noexcept;
};

// Gives the texture coordinates of a mesh in texels.
struct ChartMesh {
  std::span<const glm::vec3> positions;
  std::span<const glm::dvec2> texels;     // per vertex
  std::span<const std::uint32_t> images;  // per vertex, a number of its image; no_id: it belongs to no chart
  std::span<const Triangle> triangles;    // all corners of each have the same image
};

// Returns the charts in the order of their first triangles. Triangles are connected where they have a corner at one
// place, in space and in the image, whatever normals or colours it has. O(n log n).
[[nodiscard]] std::vector<Chart> find_charts(const ChartMesh& mesh);

// Calls visit(y, x0, x1) for rows of squares of the unit grid whose inside a triangle touches, [x0, x1) in each, each
// row once. A triangle on a line of the grid touches the squares to its right or below.
template <typename Visit>
void for_each_touched_row(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const Visit& visit) {
  const std::array<glm::dvec2, 3> corners{a, b, c};
  const auto [low, high] = std::minmax({a.y, b.y, c.y});
  const auto last = static_cast<std::int64_t>(std::max(std::floor(low), std::ceil(high) - 1.0));
  for (auto y = static_cast<std::int64_t>(std::floor(low)); y <= last; ++y) {
    const double top = static_cast<double>(y), bottom = top + 1.0;
    double left = std::numeric_limits<double>::infinity(), right = -left;
    for (std::size_t k = 0; k < 3; ++k) {  // the part of each edge that lies in the row
      const glm::dvec2 &p = corners[k], &q = corners[(k + 1) % 3];
      if (std::min(p.y, q.y) > bottom || std::max(p.y, q.y) < top) continue;
      for (const glm::dvec2& from : {p, q}) {
        const double within = std::clamp(from.y, top, bottom);
        const double x = p.y == q.y ? from.x : p.x + (q.x - p.x) * ((within - p.y) / (q.y - p.y));
        left = std::min(left, x);
        right = std::max(right, x);
      }
    }
    if (left > right) continue;
    const double first = std::floor(left);
    visit(y, static_cast<std::int64_t>(first), static_cast<std::int64_t>(std::max(std::ceil(right), first + 1.0)));
  }
}

// Does the same for squares whose centres lie in the triangle or on its border; rows without one are left out.
template <typename Visit>
void for_each_centered_row(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const Visit& visit) {
  const std::array<glm::dvec2, 3> corners{a, b, c};
  const auto [low, high] = std::minmax({a.y, b.y, c.y});
  for (auto y = static_cast<std::int64_t>(std::ceil(low - 0.5)); static_cast<double>(y) + 0.5 <= high; ++y) {
    const double line = static_cast<double>(y) + 0.5;
    double left = std::numeric_limits<double>::infinity(), right = -left;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec2 &p = corners[k], &q = corners[(k + 1) % 3];
      if (std::min(p.y, q.y) > line || std::max(p.y, q.y) < line) continue;
      const double x = p.y == q.y ? p.x : p.x + (q.x - p.x) * ((line - p.y) / (q.y - p.y));
      left = std::min({left, x, p.y == q.y ? q.x : x});
      right = std::max({right, x, p.y == q.y ? q.x : x});
    }
    const double first = std::ceil(left - 0.5), end = std::floor(right - 0.5) + 1.0;
    if (first < end) visit(y, static_cast<std::int64_t>(first), static_cast<std::int64_t>(end));
  }
}

}  // namespace occlod::tiles
