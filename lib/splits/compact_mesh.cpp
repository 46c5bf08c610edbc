#include "splits/compact_mesh.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace occlod {
namespace {

class Compaction {
 public:
  Compaction(const WedgeArrays& arrays, std::size_t vertex_count) : arrays_(arrays), new_ids_(vertex_count, no_id) {}

  void add(Triangle triangle) {
    for (int corner = 0; corner < 3; ++corner) triangle[corner] = new_id(triangle[corner]);
    mesh_.triangles.push_back(triangle);
  }
  // Adds the wedges at the corners of all faces, after add() of these. The first wedge of a vertex is the smallest that
  // is used.
  void add_wedges(std::span<const Triangle> wedges) {
    std::vector<WedgeId> first(mesh_.positions.size(), no_id);  // by new vertex id
    std::vector<std::pair<VertexId, WedgeId>> extras;
    const auto for_each_corner = [&](const auto& visit) {
      for (std::size_t t = 0; t < wedges.size(); ++t)
        for (int k = 0; k < 3; ++k) visit(mesh_.triangles[t][k], wedges[t][k]);
    };
    for_each_corner([&](VertexId v, WedgeId w) { first[v] = std::min(first[v], w); });
    for_each_corner([&](VertexId v, WedgeId w) {
      if (w != first[v]) extras.emplace_back(v, w);
    });
    std::sort(extras.begin(), extras.end());
    extras.erase(std::unique(extras.begin(), extras.end()), extras.end());
    copy_attributes(first, extras);
    if (extras.empty()) return;
    const std::size_t vertices = first.size();
    mesh_.corners.reserve(wedges.size());
    for (std::size_t t = 0; t < wedges.size(); ++t) {
      Triangle corners = mesh_.triangles[t];
      for (int k = 0; k < 3; ++k) {
        if (wedges[t][k] == first[corners[k]]) continue;
        const auto at = std::lower_bound(extras.begin(), extras.end(), std::pair(corners[k], wedges[t][k]));
        corners[k] = static_cast<WedgeId>(vertices + static_cast<std::size_t>(at - extras.begin()));
      }
      mesh_.corners.push_back(corners);
    }
  }
  [[nodiscard]] TriangleMesh take() { return std::move(mesh_); }

 private:
  VertexId new_id(VertexId v) {
    if (new_ids_[v] == no_id) {
      new_ids_[v] = static_cast<VertexId>(mesh_.positions.size());
      mesh_.positions.push_back(arrays_.positions[v]);
    }
    return new_ids_[v];
  }

  void copy_attributes(std::span<const WedgeId> first, std::span<const std::pair<VertexId, WedgeId>> extras) {
    const auto copy = [&](const auto& from, auto& to) {
      if (from.empty()) return;
      to.reserve(first.size() + extras.size());
      for (const WedgeId w : first) to.push_back(from[w]);
      for (const auto& [v, w] : extras) to.push_back(from[w]);
    };
    copy(arrays_.normals, mesh_.normals);
    copy(arrays_.colors, mesh_.colors);
    copy(arrays_.texture_coordinates, mesh_.texture_coordinates);
    for (const auto& [v, w] : extras) {
      mesh_.extra_wedges.push_back(v);
      const glm::vec3 position = mesh_.positions[v];
      mesh_.positions.push_back(position);
    }
  }

  const WedgeArrays& arrays_;
  std::vector<VertexId> new_ids_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh compact_mesh(const WedgeArrays& arrays, std::span<const Triangle> vertices,
                          std::span<const Triangle> wedges, std::size_t vertex_count) {
  Compaction compaction(arrays, vertex_count);
  for (const Triangle& t : vertices) compaction.add(t);
  compaction.add_wedges(wedges);
  return compaction.take();
}

}  // namespace occlod
