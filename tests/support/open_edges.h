// What gapes in a mesh that is drawn in parts.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <span>
#include <utility>

namespace occlod::test {

// The directed edges of triangles by the bits of their ends, each cancelled by its reverse: of a closed surface none
// are left.
class OpenEdges {
 public:
  void add(std::span<const std::uint16_t> indices, std::span<const glm::vec3> positions) {
    for (std::size_t i = 0; i < indices.size(); ++i) {
      const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
      add(positions[indices[i]], positions[indices[next]]);
    }
  }
  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(
        std::count_if(net_.begin(), net_.end(), [](const auto& edge) { return edge.second != 0; }));
  }

 private:
  using Point = std::array<float, 3>;
  void add(const glm::vec3& from, const glm::vec3& to) {
    const Point a{from.x, from.y, from.z}, b{to.x, to.y, to.z};
    net_[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
  }
  std::map<std::pair<Point, Point>, int> net_;
};

}  // namespace occlod::test
