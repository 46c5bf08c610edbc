// How the backend `gl-query` asks and how the device `gl` draws, for benchmarks and tests: the defaults serve everyone
// else.
#pragma once

#include <cstddef>
#include <memory>

#include "occlod/gl.h"

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

// As without options. Throw Error also for a flight of 0, a divisor below 1, or a target that the context is too old
// for. A count is at most the pixels of the proxy's screen rectangle, and all pixels of the image where nothing is
// known.
[[nodiscard]] std::unique_ptr<Visibility> make_query_occlusion(std::shared_ptr<Context> context,
                                                               const QueryOcclusionOptions& options);

// By which calls the device `gl` gives OpenGL what it draws.
struct HlodDeviceCalls {
  // Nodes that are drawn one after the other, without a question in between, are given to OpenGL by one call for each
  // object and buffer of meshes, where the context has OpenGL 4.3, or ARB_multi_draw_indirect and ARB_base_instance.
  // The depths and counts are the same, and so is the picture but for equal depths.
  bool indirect = true;
  // The boxes of ask_each() are drawn by one call, and each counts its pixels in a word of a storage buffer, where the
  // context has OpenGL 4.3; not with `quality`. The counts are the same as by a query for each.
  bool marks = true;
};

// As without `calls`.
[[nodiscard]] std::unique_ptr<HlodDevice> make_hlod_device(std::shared_ptr<Context> context,
                                                           const HlodDeviceOptions& options,
                                                           const HlodDeviceCalls& calls);

}  // namespace occlod::gl
