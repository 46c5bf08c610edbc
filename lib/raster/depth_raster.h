// Draws batches of projected triangles into nearness, with the widest vectors that the machine has.
#pragma once

#include <cstddef>

#include "raster/depth_image.h"
#include "raster/projection.h"

namespace occlod::raster {

// Draws the triangles of the batch that are drawable at all corners; the others are left to the caller. The same bits
// with every instruction set, and those of scan() and DepthRow. False, and nothing drawn, where the image is narrower
// than a block of pixels or the machine has no vectors. `drawn` grows around every pixel drawn.
bool draw_depth_batch(const TriangleBatch& batch, const DepthImage& target, PixelRect& drawn);
// The same; fragments are added to what is there.
bool draw_depth_batch_counted(const TriangleBatch& batch, const DepthImage& target, DrawnPixels& drawn);

}  // namespace occlod::raster
