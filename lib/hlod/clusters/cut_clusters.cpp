#include "hlod/clusters/cut_clusters.h"

#include <algorithm>
#include <glm/common.hpp>

#include "occlod/clusters.h"

namespace occlod::hlod {

void ClusterCutter::cut(std::span<const Triangle> triangles, std::span<std::uint32_t> members,
                        std::vector<Piece>& pieces) {
  items_.clear();
  for (const std::uint32_t t : members) {
    const Triangle& triangle = triangles[t];
    items_.push_back({mesh_.positions[triangle.x] + mesh_.positions[triangle.y] + mesh_.positions[triangle.z], t});
  }
  const auto count = static_cast<std::uint32_t>(members.size());
  split(triangles, items_, (count + max_triangles_ - 1) / max_triangles_, pieces);
  for (std::size_t i = 0; i < members.size(); ++i) members[i] = items_[i].triangle;
}

// Each half gets its share of the clusters, so that all are about as full. Only loose triangles have too many vertices.
void ClusterCutter::split(std::span<const Triangle> triangles, std::span<Item> items, std::uint32_t clusters,
                          std::vector<Piece>& pieces) {
  if (clusters <= 1) {
    std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.triangle < b.triangle; });
    const std::uint32_t vertices = count_vertices(triangles, items);
    if (vertices <= max_cluster_vertices) {
      pieces.push_back({static_cast<std::uint32_t>(items.size()), vertices});
      return;
    }
    clusters = 2;
  }
  glm::vec3 least = items[0].middle, most = least;
  for (const Item& item : items) {
    least = glm::min(least, item.middle);
    most = glm::max(most, item.middle);
  }
  const glm::vec3 size = most - least;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t first = clusters / 2;
  const std::size_t at = items.size() * first / clusters;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(at), items.end(),
                   [axis](const Item& a, const Item& b) {
                     return a.middle[axis] != b.middle[axis] ? a.middle[axis] < b.middle[axis]
                                                             : a.triangle < b.triangle;
                   });
  split(triangles, items.first(at), first, pieces);
  split(triangles, items.subspan(at), clusters - first, pieces);
}

std::uint32_t ClusterCutter::count_vertices(std::span<const Triangle> triangles, std::span<const Item> items) {
  ids_.reset(3 * items.size());
  for (const Item& item : items)
    for (int k = 0; k < 3; ++k) ids_.add(triangles[item.triangle][k]);
  return static_cast<std::uint32_t>(ids_.vertices().size());
}

}  // namespace occlod::hlod
