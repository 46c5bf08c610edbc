// How large a scene is, and how far its objects have moved.
#pragma once

#include <cstddef>
#include <span>

#include "occlod/refine/refiner.h"

namespace occlod {

// Over all hierarchies, each counted once.
[[nodiscard]] std::size_t splits_of(std::span<const RefineObject> objects);
// The diagonal of the box around the boxes of all objects, world units.
[[nodiscard]] double extent_of(std::span<const RefineObject> objects);
// The largest distance between two places of a corner of its box, world units.
[[nodiscard]] double moved_by(const RefineObject& from, const RefineObject& to);

}  // namespace occlod
