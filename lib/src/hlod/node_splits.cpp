#include "node_splits.h"

#include <algorithm>
#include <limits>

namespace occlod::hlod {

NodeSplitsData number_splits(const SplitsDraft& draft, std::span<const VertexId> own, LocalIds& ids) {
  NodeSplitsData result;
  if (draft.splits.empty()) return result;
  ids.reset(own.size());
  for (const VertexId v : own) ids.add(v);
  std::vector<std::uint32_t> number(draft.vertices.size(), no_id);
  std::vector<bool> is_merged(draft.vertices.size(), false);
  for (const SplitsDraft::Split& split : draft.splits) is_merged[split.v] = true;
  for (std::size_t v = 0; v < number.size(); ++v)
    if (!is_merged[v]) number[v] = ids.find(draft.vertices[v]);
  const auto add_vertex = [&](std::uint16_t v) {
    number[v] = static_cast<std::uint32_t>(own.size() + result.vertices.size());
    result.vertices.push_back(draft.vertices[v]);
  };
  for (const std::uint16_t v : draft.indices)
    if (number[v] == no_id && !is_merged[v]) add_vertex(v);
  for (const SplitsDraft::Split& split : draft.splits) {
    result.parents.push_back(static_cast<std::uint16_t>(number[split.u]));
    result.errors.push_back(split.error);
    add_vertex(split.v);
  }
  for (const std::uint16_t v : draft.indices) result.indices.push_back(static_cast<std::uint16_t>(number[v]));
  return result;
}

void append_splits(const TriangleMesh& mesh, std::span<const NodeSplitsData> splits, HlodData& data) {
  const bool has_normals = !mesh.normals.empty(), has_colors = !mesh.colors.empty();
  std::uint64_t end = 0;
  for (const NodeSplitsData& of_node : splits) {
    const auto count = static_cast<std::uint32_t>(of_node.errors.size());
    const auto bare = static_cast<std::uint32_t>(of_node.vertices.size()) - count;
    const NodeWithin within{end, count, bare, static_cast<std::uint32_t>(of_node.indices.size() / 3), 0};
    end = align_mesh(end + SplitsLayout(within, has_normals, has_colors).bytes);
    data.within.push_back(within);
  }
  data.splits.resize(end);
  for (std::size_t n = 0; n < splits.size(); ++n) {
    const SplitsLayout layout(data.within[n], has_normals, has_colors);
    std::byte* const to = data.splits.data() + data.within[n].place;
    copy_vertices(mesh, splits[n].vertices, layout, to);
    std::ranges::copy(splits[n].errors, reinterpret_cast<float*>(to + layout.errors));
    std::ranges::copy(splits[n].indices, reinterpret_cast<std::uint16_t*>(to + layout.indices));
    std::ranges::copy(splits[n].parents, reinterpret_cast<std::uint16_t*>(to + layout.parents));
  }
}

}  // namespace occlod::hlod
