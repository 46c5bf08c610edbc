#include "hlod/build/shared_vertices.h"

#include "splits/parallel.h"

namespace occlod::hlod {

// Each thread scans all triangles and handles the vertices of its part.
LargeVector<std::uint8_t> shared_vertices(std::span<const Triangle> triangles, std::span<const std::uint32_t> group_of,
                                          std::size_t vertex_count, unsigned threads) {
  LargeVector<std::uint8_t> shared(vertex_count, 0);
  LargeVector<std::uint32_t> first_user(vertex_count, no_id);
  for_each_part(vertex_count, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    for_each_id(triangles.size(), 1, [&](std::uint32_t t) {
      for (int k = 0; k < 3; ++k) {
        const VertexId v = triangles[t][k];
        if (v < begin || v >= end) continue;
        if (first_user[v] == no_id) first_user[v] = group_of[t];
        if (first_user[v] != group_of[t]) shared[v] = 1;
      }
    });
  });
  return shared;
}

}  // namespace occlod::hlod
