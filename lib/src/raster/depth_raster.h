// Draws batches of projected triangles into inverse depth, with the widest vectors that the machine has.
#pragma once

#include <cstddef>

#include "occlod/raster/item_buffer.h"
#include "raster/projection.h"

namespace occlod::raster {

// Narrower images are drawn without vectors: a block of pixels is moved left to end at the image's border.
inline constexpr int narrowest_simd_image = 16;

// The triangles of the batch that are drawable at all corners; the others are left to the caller. The same bits with
// every instruction set, and those of scan() and DepthPlane. target.width >= narrowest_simd_image.
void draw_depth_batch(const TriangleBatch& batch, const DepthImage& target);

}  // namespace occlod::raster
