// The slow and exact answer to "is any of this bound in front of the occluder?": a ray through each pixel centre.
#pragma once

#include <cstdint>

#include "occlod/raster/item_buffer.h"
#include "occlod/refine/visibility.h"

namespace occlod::bench {

struct RayVerdict {
  std::uint32_t covered = 0;  // pixel centres inside the bound's outline
  std::uint32_t visible = 0;  // of those, where the bound begins in front of the occluder or on it
};

// Of a sphere, box or cylinder before the eye, in double precision. O(pixels of the rectangle).
[[nodiscard]] RayVerdict cast_rays(const View& view, const ObjectView& object, const VisibilityQuery& query,
                                   const DepthBuffer& occluder);

}  // namespace occlod::bench
