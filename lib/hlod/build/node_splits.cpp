#include "hlod/build/node_splits.h"

#include <algorithm>
#include <limits>

#include "splits/parallel.h"

namespace occlod::hlod {

NodeSplitsData number_splits(const SplitsDraft& draft, std::span<const WedgeId> own, LocalIds& ids) {
  NodeSplitsData result;
  if (draft.splits.empty()) return result;
  ids.reset(own.size());
  for (const WedgeId v : own) ids.add(v);
  std::vector<std::uint32_t> number(draft.wedges.size(), no_id);
  std::vector<bool> is_merged(draft.wedges.size(), false);
  for (const SplitsDraft::Split& split : draft.splits) is_merged[split.v] = true;
  for (std::size_t v = 0; v < number.size(); ++v)
    if (!is_merged[v]) number[v] = ids.find(draft.wedges[v]);
  const auto add_vertex = [&](std::uint16_t v) {
    number[v] = static_cast<std::uint32_t>(own.size() + result.wedges.size());
    result.wedges.push_back(draft.wedges[v]);
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

void append_splits(const WedgeMesh& mesh, std::span<const NodeSplitsData> splits, HlodData& data) {
  std::uint64_t end = 0;
  for (const NodeSplitsData& of_node : splits) {
    const auto count = static_cast<std::uint32_t>(of_node.errors.size());
    const auto bare = static_cast<std::uint32_t>(of_node.wedges.size()) - count;
    const NodeWithin within{end, count, bare, static_cast<std::uint32_t>(of_node.indices.size() / 3), 0};
    end = align_mesh(end + SplitsLayout(within, arrays_of(data)).bytes);
    data.within.push_back(within);
  }
  data.splits.resize(end);
  for (std::size_t n = 0; n < splits.size(); ++n) {
    const SplitsLayout layout(data.within[n], arrays_of(data));
    std::byte* const to = data.splits.data() + data.within[n].place;
    copy_wedges(mesh, splits[n].wedges, layout, to);
    std::ranges::copy(splits[n].errors, reinterpret_cast<float*>(to + layout.errors));
    std::ranges::copy(splits[n].indices, reinterpret_cast<std::uint16_t*>(to + layout.indices));
    std::ranges::copy(splits[n].parents, reinterpret_cast<std::uint16_t*>(to + layout.parents));
  }
}

void copy_wedges(const WedgeMesh& mesh, std::span<const WedgeId> wedges, const VertexLayout& layout, std::byte* to) {
  const auto copy = [&](const auto& from, std::size_t offset) {
    using T = typename std::decay_t<decltype(from)>::value_type;
    if (from.empty()) return;
    T* const values = reinterpret_cast<T*>(to + offset);
    for_each_id(wedges.size(), 1, [&](std::uint32_t i) { values[i] = from[wedges[i]]; });
  };
  copy(mesh.positions, 0);
  copy(mesh.normals, layout.normals);
  copy(mesh.colors, layout.colors);
  copy(mesh.texture_coordinates, layout.texture_coordinates);
  copy(mesh.wedge_materials, layout.materials);
}

}  // namespace occlod::hlod
