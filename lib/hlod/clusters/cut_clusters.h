// Cuts the triangles of one group into clusters.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hlod/build/level_draft.h"
#include "occlod/mesh.h"

namespace occlod::hlod {

// Cuts triangles into clusters of about equal size that are compact: in halves across the longest side of the box
// around their middles, and again. One thread at a time.
class ClusterCutter {
 public:
  // `mesh` must outlive the cutter.
  ClusterCutter(const WedgeMesh& mesh, std::uint32_t max_triangles) : mesh_(mesh), max_triangles_(max_triangles) {}

  // A cluster: the next so many of the ordered triangles, and their vertices.
  struct Piece {
    std::uint32_t triangles = 0;
    std::uint32_t vertices = 0;
  };

  // Orders `members`, ids of `triangles`, cluster by cluster, and appends the clusters. Expected O(n log n).
  void cut(std::span<const Triangle> triangles, std::span<std::uint32_t> members, std::vector<Piece>& pieces);

 private:
  struct Item {
    glm::vec3 middle;  // times three
    std::uint32_t triangle;
  };

  void split(std::span<const Triangle> triangles, std::span<Item> items, std::uint32_t clusters,
             std::vector<Piece>& pieces);
  [[nodiscard]] std::uint32_t count_vertices(std::span<const Triangle> triangles, std::span<const Item> items);

  const WedgeMesh& mesh_;
  std::uint32_t max_triangles_;
  std::vector<Item> items_;
  LocalIds ids_;
};

}  // namespace occlod::hlod
