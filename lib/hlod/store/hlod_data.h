// Owns the arrays of an HLOD, and lays out and checks those of its nodes.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/memory.h"
#include "hlod/store/features.h"
#include "occlod/hlod.h"

namespace occlod::hlod {

// Has the fields of an HlodView.
struct HlodData {
  std::vector<Node> nodes;
  std::vector<Patch> patches;
  std::vector<NodeId> children;
  std::vector<NodeId> roots;
  std::vector<Level> levels;
  UninitializedVector<std::byte> meshes;  // whose nodes several threads fill; bytes between arrays are 0
  Box box;
  std::uint64_t input_triangle_count = 0;
  Grouping grouping = Grouping::shifted;
  Borders borders = Borders::locked;
  std::uint32_t node_triangles = 0;
  bool has_normals = false;
  bool has_colors = false;
  std::vector<NodeWithin> within;
  LargeVector<std::byte> splits;
  bool has_texture_coordinates = false;
  bool has_materials = false;
  bool has_seams = false;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  TextureOrigin texture_origin = TextureOrigin::bottom_left;
  float lattice_step = 0.0F;
  glm::dvec3 origin{0.0};
  UpAxis up = UpAxis::z;
  std::vector<NodeImage> node_images;
  LargeVector<std::byte> images;
  std::vector<std::uint8_t> image_materials;
  FeatureData features;
};

[[nodiscard]] HlodView view_of(const HlodData& data);
// Makes an HLOD of arrays whose sizes and indices fit together.
[[nodiscard]] Hlod make_hlod(HlodData data);
[[nodiscard]] HlodData copy_data(const Hlod& hlod);

// Tells which attributes vertices have.
struct VertexArrays {
  bool normals = false, colors = false, texture_coordinates = false, materials = false;
};

// Accepts an HlodView or HlodData.
template <typename Data>
VertexArrays arrays_of(const Data& data) {
  return {data.has_normals, data.has_colors, data.has_texture_coordinates, data.has_materials};
}

// Gives the places of a node's attributes, in this order, in bytes from the start of the positions.
struct VertexLayout {
  VertexLayout(std::size_t vertices, const VertexArrays& arrays);

  std::size_t normals, colors, texture_coordinates, materials;
  std::size_t end;
};

// Gives the places of the other arrays of a node's mesh, after the attributes and in this order, in bytes from the
// start of the mesh.
struct MeshLayout : VertexLayout {
  MeshLayout(const Node& node, const VertexArrays& arrays);

  std::size_t indices, merged_into;
  std::size_t bytes;  // without padding before the next mesh
};

// Gives the places of the arrays of a node's splits.
struct SplitsLayout : VertexLayout {
  SplitsLayout(const NodeWithin& within, const VertexArrays& arrays);

  std::size_t errors, indices, parents;
  std::size_t bytes;
};

// Returns the mesh of node n, whose arrays begin at `bytes`, and whose image, where it has one, at `image`.
[[nodiscard]] NodeMesh mesh_at(const HlodView& view, NodeId n, const std::byte* bytes, const std::byte* image) noexcept;

// These are the checks of validate() for an HLOD whose meshes lie elsewhere: `mesh_bytes` is the size of all of them,
// and `mesh` is that of node n. They return the first problem, or nothing.
[[nodiscard]] std::optional<std::string> check_structure(const HlodView& data, std::uint64_t mesh_bytes);
[[nodiscard]] std::optional<std::string> check_mesh(const HlodView& data, NodeId n, const NodeMesh& mesh);

constexpr std::uint64_t align_mesh(std::uint64_t offset) {
  return (offset + mesh_alignment - 1) / mesh_alignment * mesh_alignment;
}

// Returns the size of the mesh of node n with padding for what follows.
[[nodiscard]] inline std::size_t padded_mesh_bytes(const HlodView& view, NodeId n) {
  return align_mesh(MeshLayout(view.nodes[n], arrays_of(view)).bytes);
}

// Returns the size of the image of node n in memory; 0 where it has none.
[[nodiscard]] inline std::size_t image_bytes_of(const HlodView& view, NodeId n) noexcept {
  return view.node_images.empty() ? 0 : view.node_images[n].bytes;
}

// Lets an HLOD be used before all of it has been read: mesh and splits of each node are checked when they are first
// needed. Any number of threads may use it.
class NodeGuard {
 public:
  // `within_count` is the number of nodes whose splits are checked: none or all.
  NodeGuard(std::size_t node_count, std::size_t within_count) : checked_(node_count), within_checked_(within_count) {}
  NodeGuard(const NodeGuard&) = delete;
  NodeGuard& operator=(const NodeGuard&) = delete;
  virtual ~NodeGuard() = default;

  // Marks the node's mesh as checked. Throws Error when it is damaged.
  void check(NodeId n) {
    check_node(n);
    checked_[n].store(true, std::memory_order_release);
  }

  // Marks the node's splits as checked. Throws Error when they are damaged.
  void check_within(NodeId n) {
    check_splits(n);
    within_checked_[n].store(true, std::memory_order_release);
  }

  // Returns a mark for each node. Whoever has seen the mark may use what was checked.
  [[nodiscard]] const std::atomic<bool>* checked() const noexcept { return checked_.data(); }
  // Returns the marks of the nodes' splits; null when there are no splits.
  [[nodiscard]] const std::atomic<bool>* within_checked() const noexcept {
    return within_checked_.empty() ? nullptr : within_checked_.data();
  }

 private:
  virtual void check_node(NodeId n) = 0;
  virtual void check_splits(NodeId n) = 0;

  std::vector<std::atomic<bool>> checked_, within_checked_;
};

// Returns an HLOD whose arrays `owner` keeps alive; `guard` checks those of each node before they are first used.
[[nodiscard]] Hlod guarded_hlod(const HlodView& view, std::shared_ptr<const void> owner,
                                std::shared_ptr<NodeGuard> guard);

}  // namespace occlod::hlod
