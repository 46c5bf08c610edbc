#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "base/threads.h"
#include "hlod/build/level_draft.h"
#include "hlod/build/simplify_nodes.h"
#include "hlod/store/hlod_data.h"

namespace occlod::hlod {
namespace {

// Holds the arrays of NodeSplits. They are all empty for a node without splits.
struct NodeSplitsData {
  std::vector<WedgeId> wedges;  // bare ones, then one per split
  std::vector<float> errors;
  std::vector<std::uint16_t> indices, parents;
};

// Writes the positions and attributes of wedges to `to`, at the places that `layout` gives.
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

// Numbers the wedges of `draft`. Those in the node's mesh (`own`) keep their numbers there. `ids` is scratch memory.
// Expected O(n).
[[nodiscard]] NodeSplitsData number_splits(const SplitsDraft& draft, std::span<const WedgeId> own, LocalIds& ids) {
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

// Lays the splits of all nodes out in `data`, whose nodes are complete. O(n).
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

// Holds the vertices and patches of one node.
struct NodeParts {
  std::vector<WedgeId> wedges;  // in the order of their first use
  std::vector<std::uint16_t> indices;
  std::vector<Patch> patches;
  std::vector<FeatureRun> features;
};

constexpr std::size_t nodes_at_once = 512;  // number of nodes whose parts are in memory before they are written

class Assembler {
 public:
  Assembler(const WedgeMesh& mesh, std::vector<LevelDraft> levels, Within within, unsigned threads)
      : mesh_(mesh), levels_(std::move(levels)), within_(within), threads_(threads) {}

  HlodData run() {
    describe_input();
    number_nodes();
    reserve();
    std::vector<NodeParts> parts(nodes_at_once);
    for (NodeId first = 0; first < drafts_.size(); first += nodes_at_once) {
      const auto end = static_cast<NodeId>(std::min(drafts_.size(), first + nodes_at_once));
      for_each_node(first, end, [&](LocalIds& ids, NodeId n) { divide(ids, n, parts[n - first]); });
      for (NodeId n = first; n < end; ++n) {
        make_room();
        lay_out(n, parts[n - first]);
      }
      for_each_node(first, end, [&](LocalIds&, NodeId n) { write_mesh(n, parts[n - first]); });
    }
    for_each_node(0, static_cast<NodeId>(drafts_.size()), [&](LocalIds& ids, NodeId n) { link_merged(ids, n); });
    if (within_ == Within::splits) add_splits();
    return std::move(data_);
  }

 private:
  void describe_input() {
    const WedgeMesh& input = mesh_;
    data_.box = bounding_box(std::span<const glm::vec3>(input.positions).first(input.vertex_count()));
    data_.lattice_step = input.lattice_step;
    data_.input_triangle_count = input.triangles.size();
    data_.has_normals = !input.normals.empty();
    data_.has_colors = !input.colors.empty();
    data_.has_texture_coordinates = !input.texture_coordinates.empty();
    data_.has_materials = !mesh_.wedge_materials.empty();
    data_.has_seams = !levels_[0].corners.empty();
    data_.materials = input.materials;
    data_.textures = input.textures;
    data_.texture_origin = input.texture_origin;
    data_.origin = input.origin;
    data_.up = input.up;
    data_.features.names = input.feature_names;
    if (!input.feature_names.empty()) data_.features.first_run.push_back(0);
  }

  template <typename Visit>
  void for_each_node(NodeId begin, NodeId end, const Visit& visit) {
    for_each_task(
        end - begin, threads_, [] { return LocalIds(); },
        [&](LocalIds& ids, std::size_t i) { visit(ids, static_cast<NodeId>(begin + i)); }, [] {});
  }

  // Reserves what most surfaces need, so that arrays need not be copied when they grow.
  void reserve() {
    std::size_t triangles = 0;
    for (const NodeDraft* draft : drafts_) triangles += draft->triangle_count;
    wedges_.reserve(triangles * 2 / 3);
    Node two;  // room for the vertices of three triangles
    two.vertices = 2;
    two.triangles = 3;
    data_.meshes.reserve(triangles / 3 * MeshLayout(two, arrays_of(data_)).bytes + drafts_.size() * mesh_alignment);
  }

  void number_nodes() {
    data_.levels.resize(levels_.size());
    for (std::size_t level = levels_.size(); level-- > 0;) {
      data_.levels[level] = {static_cast<NodeId>(drafts_.size()),
                             static_cast<std::uint32_t>(levels_[level].nodes.size())};
      for (const NodeDraft& draft : levels_[level].nodes) {
        drafts_.push_back(&draft);
        Node node;
        node.level = static_cast<std::uint16_t>(level);
        data_.nodes.push_back(node);
      }
    }
  }

  // Returns the id of the node at `place` on the level above that of n.
  [[nodiscard]] NodeId parent_id(NodeId n, std::uint32_t place) const {
    return data_.levels[data_.nodes[n].level + 1U].first_node + place;
  }

  // Divides the node's triangles into patches by ascending parent. Within a patch they are sorted by material and
  // feature, and otherwise keep their order.
  void divide(LocalIds& ids, NodeId n, NodeParts& parts) const {
    const NodeDraft& draft = *drafts_[n];
    const LevelDraft& level = levels_[data_.nodes[n].level];
    std::vector<std::tuple<NodeId, MaterialId, FeatureId, std::uint32_t>> order;
    for (std::uint32_t t = draft.first_triangle; t < draft.first_triangle + draft.triangle_count; ++t) {
      const WedgeId wedge = level.wedge_triangles()[t].x;
      order.emplace_back(level.parent_of.empty() ? no_id : parent_id(n, level.parent_of[t]), mesh_.material_of(wedge),
                         mesh_.feature_of(wedge), t);
    }
    std::sort(order.begin(), order.end());
    parts = {};
    ids.reset(3 * order.size() + draft.bare_targets.size());
    for (const auto& [parent, material, feature, t] : order) {
      if (!mesh_.wedge_features.empty() && (parts.features.empty() || parts.features.back().feature != feature))
        parts.features.push_back({static_cast<std::uint32_t>(parts.indices.size() / 3), feature});
      if (parts.patches.empty() || parts.patches.back().parent != parent)
        parts.patches.push_back({parent, static_cast<std::uint32_t>(parts.indices.size()), 0});
      parts.patches.back().index_count += 3;
      for (int k = 0; k < 3; ++k)
        parts.indices.push_back(static_cast<std::uint16_t>(ids.add(level.wedge_triangles()[t][k])));
    }
    for (const WedgeId v : draft.bare_targets) ids.add(v);
    parts.wedges.assign(ids.vertices().begin(), ids.vertices().end());
  }

  // Sets the node's own fields and the places of its arrays.
  void lay_out(NodeId n, const NodeParts& parts) {
    const NodeDraft& draft = *drafts_[n];
    Node& node = data_.nodes[n];
    node.box = draft.box;
    node.lod_box = draft.lod_box;
    node.sphere = draft.sphere;
    node.error = draft.error;
    node.child_error = draft.child_error;
    node.guaranteed_error = draft.guaranteed_error;
    node.area = draft.area;
    node.first_patch = static_cast<std::uint32_t>(data_.patches.size());
    node.first_child = static_cast<std::uint32_t>(data_.children.size());
    node.triangles = draft.triangle_count;
    node.vertices = static_cast<std::uint32_t>(parts.wedges.size());
    node.patches = static_cast<std::uint16_t>(parts.patches.size());
    node.children = static_cast<std::uint16_t>(draft.children.size());
    node.mesh = data_.meshes.size();
    data_.meshes.resize(align_mesh(node.mesh + MeshLayout(node, arrays_of(data_)).bytes));
    data_.patches.insert(data_.patches.end(), parts.patches.begin(), parts.patches.end());
    for (const std::uint32_t child : draft.children)
      data_.children.push_back(data_.levels[node.level - 1U].first_node + child);
    FeatureData& features = data_.features;
    features.runs.insert(features.runs.end(), parts.features.begin(), parts.features.end());
    if (!features.names.empty()) features.first_run.push_back(static_cast<std::uint32_t>(features.runs.size()));
    if (parts.patches.empty() || parts.patches[0].parent == no_id) data_.roots.push_back(n);
    first_wedge_.push_back(wedges_.size());
    wedges_.insert(wedges_.end(), parts.wedges.begin(), parts.wedges.end());
  }

  [[nodiscard]] std::span<const WedgeId> wedges_of(NodeId n) const {
    return std::span<const WedgeId>(wedges_).subspan(first_wedge_[n], data_.nodes[n].vertices);
  }

  template <typename T>
  [[nodiscard]] T* array_at(const Node& node, std::size_t offset) {
    return reinterpret_cast<T*>(data_.meshes.data() + node.mesh + offset);
  }

  void write_mesh(NodeId n, const NodeParts& parts) {
    const Node& node = data_.nodes[n];
    const MeshLayout layout(node, arrays_of(data_));
    std::fill_n(data_.meshes.data() + node.mesh, align_mesh(layout.bytes), std::byte{0});
    copy_wedges(mesh_, parts.wedges, layout, data_.meshes.data() + node.mesh);
    std::copy(parts.indices.begin(), parts.indices.end(), array_at<std::uint16_t>(node, layout.indices));
    std::fill_n(array_at<std::uint16_t>(node, layout.merged_into), parts.wedges.size(), stays);
  }

  // Tells the children of n where their vertices went. Only n merges these vertices, so no other parent of the child
  // writes to the same place.
  void link_merged(LocalIds& own, NodeId n) {
    const NodeDraft& draft = *drafts_[n];
    const std::span<const Merge> merges = levels_[data_.nodes[n].level].merges_of(draft);
    if (merges.empty()) return;
    own.reset(wedges_of(n).size());
    for (const WedgeId wedge : wedges_of(n)) own.add(wedge);
    LocalIds merged;
    merged.reset(merges.size());
    for (const Merge& merge : merges) merged.add(merge.v);
    for (const std::uint32_t child : draft.children) {
      const NodeId c = data_.levels[data_.nodes[n].level - 1U].first_node + child;
      const Node& node = data_.nodes[c];
      auto* const merged_into = array_at<std::uint16_t>(node, MeshLayout(node, arrays_of(data_)).merged_into);
      const auto used = wedges_of(c).first(node.vertices - drafts_[c]->bare_targets.size());
      for (std::size_t i = 0; i < used.size(); ++i)
        if (const std::uint32_t merge = merged.find(used[i]); merge != no_id)
          merged_into[i] = static_cast<std::uint16_t>(own.find(merges[merge].u));
    }
  }

  void add_splits() {
    std::vector<NodeSplitsData> splits(drafts_.size());
    for_each_node(0, static_cast<NodeId>(drafts_.size()),
                  [&](LocalIds& ids, NodeId n) { splits[n] = number_splits(drafts_[n]->within, wedges_of(n), ids); });
    append_splits(mesh_, splits, data_);
  }

  const WedgeMesh& mesh_;
  std::vector<LevelDraft> levels_;
  Within within_;
  unsigned threads_;
  std::vector<const NodeDraft*> drafts_;  // per node
  LargeVector<WedgeId> wedges_;           // of the vertices of all nodes
  std::vector<std::size_t> first_wedge_;  // per node, into wedges_
  HlodData data_;
};

}  // namespace

HlodData assemble(const WedgeMesh& mesh, std::vector<LevelDraft> levels, Within within, unsigned threads) {
  return Assembler(mesh, std::move(levels), within, threads).run();
}

}  // namespace occlod::hlod
