// From the collapses of a node to the splits that an HLOD stores.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hlod_data.h"
#include "level_draft.h"
#include "local_ids.h"

namespace occlod::hlod {

// The arrays of NodeSplits. All empty: none.
struct NodeSplitsData {
  std::vector<VertexId> vertices;  // of the input mesh: bare ones, then one for each split
  std::vector<float> errors;
  std::vector<std::uint16_t> indices, parents;
};

// Numbers the vertices of `draft`, those in the node's mesh (`own`) as they are there. `ids` is scratch memory.
// Expected O(n).
[[nodiscard]] NodeSplitsData number_splits(const SplitsDraft& draft, std::span<const VertexId> own, LocalIds& ids);

// Lays the splits of all nodes out in `data`, whose nodes are complete. O(n).
void append_splits(const TriangleMesh& mesh, std::span<const NodeSplitsData> splits, HlodData& data);

// Writes the attributes of vertices to `to`, where `layout` has them.
template <typename Layout>
void copy_vertices(const TriangleMesh& mesh, std::span<const VertexId> vertices, const Layout& layout, std::byte* to) {
  const auto copy = [&](const auto& from, std::size_t offset) {
    using T = typename std::decay_t<decltype(from)>::value_type;
    if (from.empty()) return;
    for (std::size_t i = 0; i < vertices.size(); ++i) reinterpret_cast<T*>(to + offset)[i] = from[vertices[i]];
  };
  copy(mesh.positions, 0);
  copy(mesh.normals, layout.normals);
  copy(mesh.colors, layout.colors);
}

}  // namespace occlod::hlod
