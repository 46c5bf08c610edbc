// The backend `gl-query`: OpenGL occlusion queries in flights, as in Birkholz & Rahn, sec. 3.1 and 3.3.
#pragma once

#include <cstddef>
#include <memory>

#include "occlod/gl/context.h"
#include "occlod/refine/visibility.h"

namespace occlod::gl {

// What OpenGL is asked for.
enum class QueryTarget {
  any,               // GL_ANY_SAMPLES_PASSED
  any_conservative,  // GL_ANY_SAMPLES_PASSED_CONSERVATIVE, OpenGL 4.3: may say visible where nothing is, never hidden
  count,             // GL_SAMPLES_PASSED: answers with a number of pixels
};

// How the backend `gl-query` asks.
struct QueryOcclusionOptions {
  // Queries that refinement keeps under way, >= 1. The order of its queries, hence its result, depends on this.
  std::size_t flight = 32;
  // Of those, queries that OpenGL holds at a time; only time depends on it. 0: measured in the first view, as many as
  // can be issued between issuing one and its answer, and at most the flight.
  std::size_t window = 0;
  QueryTarget target = QueryTarget::any;  // the kind of query
  // Proxies are drawn into a target with one sample for divisor x divisor pixels, >= 1. A sample holds the farthest
  // depth of the occluder on its pixels, and proxies are enlarged accordingly: as conservative, less tight.
  int divisor = 1;
};

// Draws both sides of the occluder into a depth target of the view's size and asks with proxy volumes: boxes of 12
// triangles (for PointHull too), spheres of 32 and cylinders of 64, each circumscribed and enlarged by 3/4 pixel so
// that a bound is never missed between two samples. Answered visible without a query: bounds that are not finite or
// inside out, whose proxy reaches the near plane, or whose image is larger than the screen in both directions or more
// than eight times as large in one. Answered hidden without a query: bounds off the screen. A count is at most the
// pixels of the proxy's screen rectangle, and all pixels of the image where nothing is known.
//
// Between begin_view() and the last collect() the context belongs to this backend, which does not restore the state
// that it sets. Throws Error for no context, a flight of 0, a divisor below 1, or a target that the context is too old
// for; collect() when the driver has not answered after 10 s; begin_view(), draw_occluder() and the collect() after
// which no query is under way when OpenGL reports an error.
[[nodiscard]] std::unique_ptr<Visibility> make_query_occlusion(std::shared_ptr<Context> context,
                                                               const QueryOcclusionOptions& options = {});

}  // namespace occlod::gl
