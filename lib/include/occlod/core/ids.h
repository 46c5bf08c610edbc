// Index types shared by every layer. Plain integers: they index plain arrays.
#pragma once

#include <cstdint>
#include <limits>

namespace occlod {

using VertexId = std::uint32_t;  // into TriangleMesh::positions or Hierarchy::positions()
using SplitId = std::uint32_t;   // into HierarchyView::nodes, from coarse to fine; a split depends on smaller ids only
using WedgeId = std::uint32_t;   // into TriangleMesh::positions or Hierarchy::positions(): a vertex with its attributes
using MaterialId = std::uint16_t;  // into TriangleMesh::materials or HierarchyView::materials
using TextureId = std::uint16_t;   // into TriangleMesh::textures or HierarchyView::textures

// "No vertex" or "no split".
inline constexpr std::uint32_t no_id = std::numeric_limits<std::uint32_t>::max();
// "No texture".
inline constexpr TextureId no_texture = std::numeric_limits<TextureId>::max();

}  // namespace occlod
