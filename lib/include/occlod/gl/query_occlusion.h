// The backend `gl-query`: OpenGL occlusion queries in flights, as in Birkholz & Rahn, sec. 3.1 and 3.3.
#pragma once

#include <cstddef>
#include <memory>

#include "occlod/gl/context.h"
#include "occlod/refine/visibility.h"

namespace occlod::gl {

enum class QueryTarget {
  any,               // GL_ANY_SAMPLES_PASSED
  any_conservative,  // GL_ANY_SAMPLES_PASSED_CONSERVATIVE, OpenGL 4.3: may say visible where nothing is, never hidden
  count,             // GL_SAMPLES_PASSED: answers with a number of pixels
};

struct QueryOcclusionOptions {
  // Questions that refinement keeps under way, >= 1. The order of its questions, hence its result, depends on this.
  std::size_t flight = 32;
  // Of those, queries that OpenGL holds at once. Nothing but time depends on it. 0 = measured in the first view: as
  // many as can be issued between issuing one and its answer, and at most the flight.
  std::size_t window = 0;
  QueryTarget target = QueryTarget::any;
  // Proxies are drawn into a target with one sample for divisor x divisor pixels, >= 1. Each holds the farthest depth
  // of the occluder on its pixels, and proxies grow by so many times more: as conservative, less tight.
  int divisor = 1;
};

// Draws the occluder, both faces, into a depth target of the view's size and asks with proxy volumes: boxes of 12
// triangles (PointHull too), spheres of 32 and cylinders of 64, each circumscribed and grown by 3/4 pixel so that a
// bound is never missed between two samples. Answered visible without a query: bounds that are not finite or inside
// out, whose proxy reaches the near plane, or whose image is larger than the screen, that is in both directions or in
// one by more than eight times. Answered hidden without a query: off the screen. A count is at most the pixels of the
// proxy's screen rectangle; all pixels of the image where nothing is known.
//
// Between begin_view and the last collect the context is this backend's alone; it leaves the state behind that it has
// set. collect() throws Error when the driver has not answered after 10 s, and so do begin_view, draw_occluder and the
// collect() after which none is under way when it reports an error. Throws Error for no context, a flight of 0, a
// divisor below 1, or a target that the context is too old for.
[[nodiscard]] std::unique_ptr<Visibility> make_query_occlusion(std::shared_ptr<Context> context,
                                                               const QueryOcclusionOptions& options = {});

}  // namespace occlod::gl
