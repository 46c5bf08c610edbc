// Places on the WGS84 ellipsoid.
#pragma once

#include <glm/mat4x4.hpp>

#include "occlod/tiles/write_tileset.h"

namespace occlod::tiles {

// From metres to the east, north and up of a place to Earth-centred, Earth-fixed metres. At the poles east is where it
// is along the meridian of the given longitude.
[[nodiscard]] glm::dmat4 east_north_up(const GeodeticOrigin& origin);

}  // namespace occlod::tiles
