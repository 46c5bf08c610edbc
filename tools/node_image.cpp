#include "node_image.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <utility>
#include <vector>

#include "hlod/texture/charts.h"
#include "image_file.h"

namespace occlod::tool {
namespace {

// Colours, and which of them are known.
struct Level {
  Image image;
  std::vector<std::uint8_t> is_known;

  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
  }
};

// Marks what triangles touch, and the texels around. Triangles that are at one place show no image.
void mark_shown(Level& level, const hlod::NodeMesh& mesh) {
  const glm::dvec2 size(level.image.width, level.image.height);
  const auto clamped = [](std::int64_t i, int end) { return static_cast<int>(std::clamp<std::int64_t>(i, 0, end)); };
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto corner = [&](std::size_t k) { return mesh.image_coordinates[mesh.indices[i + k]]; };
    if (corner(0) == corner(1) && corner(1) == corner(2)) continue;
    const auto at = [&](std::size_t k) { return glm::dvec2(corner(k)) / 65535.0 * size; };
    tiles::for_each_touched_row(at(0), at(1), at(2), [&](std::int64_t y, std::int64_t x0, std::int64_t x1) {
      const int left = clamped(x0 - 1, level.image.width), right = clamped(x1 + 1, level.image.width);
      for (int row = clamped(y - 1, level.image.height); row < clamped(y + 2, level.image.height); ++row)
        std::fill_n(level.is_known.begin() + static_cast<std::ptrdiff_t>(level.at(left, row)), right - left,
                    std::uint8_t{1});
    });
  }
}

// Returns half the size, each colour the mean of those known of four.
Level half_of(const Level& level) {
  Level half{{(level.image.width + 1) / 2, (level.image.height + 1) / 2, {}}, {}};
  for (int y = 0; y < half.image.height; ++y)
    for (int x = 0; x < half.image.width; ++x) {
      glm::ivec4 sum(0);
      int known = 0;
      for (int row = 2 * y; row < std::min(2 * y + 2, level.image.height); ++row)
        for (int column = 2 * x; column < std::min(2 * x + 2, level.image.width); ++column) {
          if (level.is_known[level.at(column, row)] == 0) continue;
          sum += glm::ivec4(level.image.pixels[level.at(column, row)]);
          ++known;
        }
      half.image.pixels.emplace_back(sum / std::max(known, 1));
      half.is_known.push_back(known > 0 ? 1 : 0);
    }
  return half;
}

void fill(Level& level, const Level& half) {
  for (int y = 0; y < level.image.height; ++y)
    for (int x = 0; x < level.image.width; ++x)
      if (level.is_known[level.at(x, y)] == 0)
        level.image.pixels[level.at(x, y)] = half.image.pixels[half.at(x / 2, y / 2)];
}

}  // namespace

Image image_of_node(const hlod::NodeMesh& mesh, const std::string& name) {
  std::vector<Level> levels;
  levels.push_back({decode_image(mesh.image, name), {}});
  levels[0].is_known.assign(levels[0].image.pixels.size(), 0);
  mark_shown(levels[0], mesh);
  while (std::ranges::find(levels.back().is_known, std::uint8_t{0}) != levels.back().is_known.end() &&
         levels.back().is_known.size() > 1)
    levels.push_back(half_of(levels.back()));
  for (std::size_t i = levels.size() - 1; i-- > 0;) fill(levels[i], levels[i + 1]);
  return std::move(levels[0].image);
}

}  // namespace occlod::tool
