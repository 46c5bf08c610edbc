// The arrays of an HLOD where they are built.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/large_vector.h"
#include "occlod/hlod/hlod.h"

namespace occlod::hlod {

// The fields of an HlodView.
struct HlodData {
  std::vector<Node> nodes;
  std::vector<Patch> patches;
  std::vector<NodeId> children;
  std::vector<NodeId> roots;
  std::vector<Level> levels;
  LargeVector<std::byte> meshes;
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
};

[[nodiscard]] HlodView view_of(const HlodData& data);
// Takes arrays whose sizes and indices fit together.
[[nodiscard]] Hlod make_hlod(HlodData data);
[[nodiscard]] HlodData copy_data(const Hlod& hlod);

// Which attributes vertices have.
struct VertexArrays {
  bool normals = false, colors = false, texture_coordinates = false, materials = false;
};

// `data`: HlodView or HlodData.
template <typename Data>
VertexArrays arrays_of(const Data& data) {
  return {data.has_normals, data.has_colors, data.has_texture_coordinates, data.has_materials};
}

// Where attributes begin, in bytes from the start of the positions. In this order.
struct VertexLayout {
  VertexLayout(std::size_t vertices, const VertexArrays& arrays);

  std::size_t normals, colors, texture_coordinates, materials;
  std::size_t end;
};

// Where the arrays of one node's mesh begin, in bytes from the start of the mesh. In this order, after attributes.
struct MeshLayout : VertexLayout {
  MeshLayout(const Node& node, const VertexArrays& arrays);

  std::size_t indices, merged_into;
  std::size_t bytes;  // without what aligns the next mesh
};

// The same for its splits.
struct SplitsLayout : VertexLayout {
  SplitsLayout(const NodeWithin& within, const VertexArrays& arrays);

  std::size_t errors, indices, parents;
  std::size_t bytes;
};

// The mesh of node n, whose arrays begin here.
[[nodiscard]] NodeMesh mesh_at(const HlodView& view, NodeId n, const std::byte* bytes) noexcept;

// As in validate.h, of an HLOD whose meshes lie elsewhere: so many bytes of all, and that of node n.
[[nodiscard]] std::optional<std::string> check_structure(const HlodView& data, std::uint64_t mesh_bytes);
[[nodiscard]] std::optional<std::string> check_mesh(const HlodView& data, NodeId n, const NodeMesh& mesh);

constexpr std::uint64_t align_mesh(std::uint64_t offset) {
  return (offset + mesh_alignment - 1) / mesh_alignment * mesh_alignment;
}

}  // namespace occlod::hlod
