// The arrays of an HLOD where they are built.
#pragma once

#include <cstddef>
#include <vector>

#include "core/large_vector.h"
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
};

[[nodiscard]] HlodView view_of(const HlodData& data);
// Takes arrays whose sizes and indices fit together.
[[nodiscard]] Hlod make_hlod(HlodData data);
[[nodiscard]] HlodData copy_data(const Hlod& hlod);

// Where the arrays of one node's mesh begin, in bytes from the start of the mesh. In this order.
struct MeshLayout {
  MeshLayout(const Node& node, bool has_normals, bool has_colors);

  std::size_t normals, colors, indices, merged_into;
  std::size_t bytes;  // without what aligns the next mesh
};

// The same for its splits.
struct SplitsLayout {
  SplitsLayout(const NodeWithin& within, bool has_normals, bool has_colors);

  std::size_t normals, colors, errors, indices, parents;
  std::size_t bytes;
};

constexpr std::uint64_t align_mesh(std::uint64_t offset) {
  return (offset + mesh_alignment - 1) / mesh_alignment * mesh_alignment;
}

}  // namespace occlod::hlod
