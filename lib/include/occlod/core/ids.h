// Index types shared by every layer. Plain integers: they index plain arrays.
#pragma once

#include <cstdint>
#include <limits>

namespace occlod {

using VertexId = std::uint32_t;  // into TriangleMesh::positions or Hierarchy::positions()
using SplitId = std::uint32_t;   // into HierarchyView::nodes, from coarse to fine; a split depends on smaller ids only

// "No vertex" or "no split".
inline constexpr std::uint32_t no_id = std::numeric_limits<std::uint32_t>::max();

}  // namespace occlod
