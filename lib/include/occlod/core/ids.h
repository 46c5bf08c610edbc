// Index types shared by every layer. Plain integers: they index plain arrays.
#pragma once

#include <cstdint>
#include <limits>

namespace occlod {

using VertexId = std::uint32_t;  // into TriangleMesh::positions or Hierarchy::positions()
using FaceId = std::uint32_t;    // into Hierarchy::faces()
using SplitId = std::uint32_t;   // into Hierarchy::nodes(); a split depends only on smaller numbers

// "No vertex", "no face", "no split".
inline constexpr std::uint32_t no_id = std::numeric_limits<std::uint32_t>::max();

}  // namespace occlod
