// The backend `gl-compute`: a depth pyramid on the GPU, and all tests of a flight in one dispatch.
#pragma once

#include <cstddef>
#include <memory>

#include "occlod/gl/context.h"
#include "occlod/refine/visibility.h"

namespace occlod::gl {

struct ComputeOcclusionOptions {
  std::size_t flight = 64;    // questions that refinement keeps under way, >= 1: answered together
  bool count_pixels = false;  // answer with the number of visible pixels of the bound's screen rectangle
};

// The test of the software backend: the bound's screen rectangle and nearest depth (screen_bounds, on the CPU) against
// the farthest depths of the occluder. The occluder is drawn by OpenGL as nearness, pushed away by 1/64 of what
// one pixel spans, for rasterisers may move it by 1/256 pixel: where software hides by less than that, this says
// visible. A test that has not ended after 16,384 texels says visible too. The occluder is cut off at the far plane.
// Needs OpenGL 4.3.
//
// The context is used as by gl-query. Throws Error for no context, one older than 4.3 or a flight of 0; draw_occluder
// and collect() when OpenGL reports an error, collect() when the driver has not answered after 10 s.
[[nodiscard]] std::unique_ptr<Visibility> make_compute_occlusion(std::shared_ptr<Context> context,
                                                                 const ComputeOcclusionOptions& options = {});

}  // namespace occlod::gl
