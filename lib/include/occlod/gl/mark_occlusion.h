// The backend `gl-mark`: all proxies of a flight in one draw, whose fragments mark what is visible.
#pragma once

#include <cstddef>
#include <memory>

#include "occlod/gl/context.h"
#include "occlod/refine/visibility.h"

namespace occlod::gl {

// How the backend `gl-mark` asks.
struct MarkOcclusionOptions {
  std::size_t flight = 64;    // queries that refinement keeps under way, >= 1: answered together
  bool count_pixels = false;  // answer with a number of pixels instead of 0 or 1
  int divisor = 1;            // one sample for divisor x divisor pixels, >= 1; see QueryOcclusionOptions
};

// Draws the occluder and proxies of gl-query and gives its answers, without query objects. When the oldest answer is
// collected, the proxies of all queries submitted since the last time are drawn, one instanced draw for each kind of
// proxy, with the depth test before the fragment shader; each fragment writes (with count_pixels: adds) to its proxy's
// word of a storage buffer, which is read back once. Needs OpenGL 4.3.
//
// The context is used as by gl-query. Throws Error for no context, one older than 4.3, a flight of 0 or a divisor below
// 1; collect() when the driver has not answered after 10 s.
[[nodiscard]] std::unique_ptr<Visibility> make_mark_occlusion(std::shared_ptr<Context> context,
                                                              const MarkOcclusionOptions& options = {});

}  // namespace occlod::gl
