// Which vertices several groups use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/large_vector.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod::hlod {

// By vertex: 1 where triangles of different groups use it, 0 elsewhere. `group_of` by triangle. The result does not
// depend on the threads. O(n * threads) steps, shared by them.
[[nodiscard]] LargeVector<std::uint8_t> shared_vertices(std::span<const Triangle> triangles,
                                                        std::span<const std::uint32_t> group_of,
                                                        std::size_t vertex_count, unsigned threads);

}  // namespace occlod::hlod
