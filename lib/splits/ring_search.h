// Searches in stars of any size, from three faces to a hundred thousand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "occlod/core/ids.h"
#include "splits/star_mesh.h"

namespace occlod {

// Puts faces into ring order, starting with the first. False, in any order, when they are not one closed fan.
[[nodiscard]] bool chain(std::span<StarFace> faces);

// Where v is in a ring, or its size. Without a branch for each of many.
[[nodiscard]] std::uint32_t position_of(std::span<const VertexId> ring, VertexId v);

// The same, of a vertex that is there, starting near `hint`.
[[nodiscard]] std::uint32_t position_near(std::span<const VertexId> ring, VertexId v, std::size_t hint);

}  // namespace occlod
