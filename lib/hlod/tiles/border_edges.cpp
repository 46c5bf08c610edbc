#include "hlod/tiles/border_edges.h"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>
#include <utility>

namespace occlod::tiles {

std::vector<std::uint32_t> first_at_position(std::span<const glm::vec3> positions) {
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t v) {
    const glm::vec3& p = positions[v];
    return std::tuple(p.x, p.y, p.z);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

std::vector<BorderEdge> border_edges(std::span<const Triangle> triangles, std::span<const std::uint32_t> first) {
  struct Use {
    std::pair<std::uint32_t, std::uint32_t> edge;  // at first vertices, the lesser first
    std::size_t corner;                            // from which it leads, of 3 for each triangle
  };
  std::vector<Use> uses;
  uses.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = first[triangles[t][k]], b = first[triangles[t][(k + 1) % 3]];
      uses.push_back({std::minmax(a, b), 3 * t + static_cast<std::size_t>(k)});
    }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) { return a.edge < b.edge; });
  std::vector<std::size_t> corners;
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    while (end < uses.size() && uses[end].edge == uses[i].edge) ++end;
    if (end - i == 1) corners.push_back(uses[i].corner);
  }
  std::sort(corners.begin(), corners.end());
  std::vector<BorderEdge> edges;
  edges.reserve(corners.size());
  for (const std::size_t corner : corners) {
    const Triangle& t = triangles[corner / 3];
    const int k = static_cast<int>(corner % 3);
    edges.push_back({t[k], t[(k + 1) % 3], static_cast<std::uint32_t>(corner / 3)});
  }
  return edges;
}

std::vector<glm::dvec3> area_sums(std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                                  std::span<const std::uint32_t> first) {
  std::vector<glm::dvec3> sums(positions.size(), glm::dvec3(0.0));
  for (const Triangle& t : triangles) {
    const glm::dvec3 a(positions[t.x]);
    const glm::dvec3 area = glm::cross(glm::dvec3(positions[t.y]) - a, glm::dvec3(positions[t.z]) - a);
    for (int k = 0; k < 3; ++k) sums[first[t[k]]] += area;
  }
  return sums;
}

}  // namespace occlod::tiles
