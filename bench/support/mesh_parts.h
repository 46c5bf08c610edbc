// The objects of a mesh: houses of a city, for what is decided object by object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "occlod/cell_builder.h"
#include "occlod/mesh.h"

namespace occlod::bench {

// What is connected through shared vertices.
struct MeshParts {
  std::vector<std::uint32_t> of_triangle;  // by triangle: its part
  std::vector<std::size_t> triangles;      // by part: how many it has
  std::vector<CellBox> boxes;              // by part
};

// Parts are numbered by their first triangle. O(n).
[[nodiscard]] MeshParts parts_of(const TriangleMesh& mesh);

}  // namespace occlod::bench
