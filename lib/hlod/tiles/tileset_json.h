// tileset.json and the external tilesets.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <optional>
#include <string>

#include "base/atomic_folder.h"
#include "hlod/tiles/tile_tree.h"

namespace occlod::tiles {

// Relative to the folder.
[[nodiscard]] std::string content_name(hlod::NodeId n);

// How many files it has written. `transform`: of the whole tileset. `tree` is complete.
std::uint64_t write_tileset_json(AtomicFolder& folder, const TileTree& tree,
                                 const std::optional<glm::dmat4>& transform);

}  // namespace occlod::tiles
