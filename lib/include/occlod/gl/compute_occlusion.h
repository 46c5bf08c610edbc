// The backend `gl-compute`: a depth pyramid on the GPU, and all tests of a flight in one dispatch.
#pragma once

#include <cstddef>
#include <memory>

#include "occlod/gl/context.h"
#include "occlod/refine/visibility.h"

namespace occlod::gl {

// How the backend `gl-compute` asks.
struct ComputeOcclusionOptions {
  std::size_t flight = 64;    // queries that refinement keeps under way, >= 1: answered together
  bool count_pixels = false;  // answer with the number of visible pixels of the bound's screen rectangle
};

// Tests as the software backend does: the bound's screen rectangle and nearest depth, computed on the CPU, against the
// farthest depths of the occluder. OpenGL draws the occluder as nearness, pushed away by 1/64 of what one pixel spans,
// since rasterisers may move it by 1/256 pixel: what software hides by a smaller margin is visible here. A test that
// has not ended after 16,384 texels answers visible too. The occluder is clipped at the far plane. Needs OpenGL 4.3.
//
// The context is used as by gl-query. Throws Error for no context, one older than 4.3 or a flight of 0; draw_occluder
// and collect() when OpenGL reports an error, collect() when the driver has not answered after 10 s.
[[nodiscard]] std::unique_ptr<Visibility> make_compute_occlusion(std::shared_ptr<Context> context,
                                                                 const ComputeOcclusionOptions& options = {});

}  // namespace occlod::gl
