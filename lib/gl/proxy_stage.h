// The occluder of one view as a single indexed mesh in clip space.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "gl/objects.h"
#include "gl/programs.h"
#include "gl/proxies.h"
#include "occlod/visibility.h"

namespace occlod::gl {

// Only the vertices that some triangle uses, each once, transformed in double precision: the product of a matrix and a
// point close to the eye cancels, and single precision would move the occluder there. An occluder uses few of its
// object's vertices, so streaming them costs less than telling whether a copy of them all on the GPU is still the same.
// Reuses its memory. No OpenGL here.
class OccluderMesh {
 public:
  // object_to_clip by object. O(triangles), and O(vertices) the first time that a part is so large.
  void assign(std::span<const OccluderPart> parts, std::span<const glm::dmat4> object_to_clip);

  [[nodiscard]] std::span<const glm::vec4> vertices() const noexcept { return vertices_; }  // clip space
  [[nodiscard]] std::span<const std::uint32_t> indices() const noexcept { return indices_; }

 private:
  void append(const OccluderPart& part, const glm::dmat4& object_to_clip);

  std::vector<glm::vec4> vertices_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint32_t> slots_;  // of a part's vertices in vertices_; all no_id between calls
};

// The same on its way to OpenGL: positions at location 0, in clip space.
class OccluderBuffer {
 public:
  explicit OccluderBuffer(const Functions& gl);
  void draw(const Functions& gl, const OccluderMesh& mesh) const;

 private:
  VertexArray array_;
  Buffer vertices_;
  Buffer indices_;
};

// The occluder in a depth buffer and the proxies before it: what gl-query and gl-mark share.

// Lives in a context that is current in every call. After begin_view and draw_occluder the target is bound and all is
// set for drawing front faces of proxies, with depth test and without depth writes. Everything that the draws depend on
// is set there, so that others may have used the context since the last view.
class ProxyStage {
 public:
  // divisor: one sample of the target for divisor x divisor pixels, at the farthest depth that the occluder has there.
  ProxyStage(const Functions& gl, int divisor);

  void begin_view(const View& view, std::span<const ObjectView> objects);
  void draw_occluder(std::span<const OccluderPart> parts);

  [[nodiscard]] const Functions& gl() const noexcept { return *gl_; }
  [[nodiscard]] const ProxyBuffer& proxies() const noexcept { return proxies_; }
  [[nodiscard]] QueryPlan plan(const VisibilityQuery& query) const;
  // The answer to a query that is not drawn: with `counts` all pixels where nothing is known.
  [[nodiscard]] std::uint32_t answer(const QueryPlan& plan, bool counts) const;
  // Pixels of the view from samples of the target that passed; max_pixels as in ProxyDraw.
  [[nodiscard]] std::uint32_t pixels(std::uint32_t samples, std::uint32_t max_pixels) const;
  // Draws one proxy, all by itself.
  void draw(const ProxyDraw& draw) const;

 private:
  void bind_target();
  void start_occluder() const;
  void reduce();
  void start_proxies() const;

  const Functions* gl_;
  int divisor_;
  Screen screen_;
  std::vector<glm::dmat4> object_to_clip_;
  std::vector<ProxySpace> spaces_;
  OccluderMesh mesh_;
  FloatTarget full_;
  std::optional<FloatTarget> reduced_;  // with a divisor above 1
  PlainProgram plain_;
  std::optional<Program> reduction_;
  VertexArray nothing_;  // OpenGL draws nothing without a vertex array, not even without attributes
  OccluderBuffer occluder_;
  ProxyBuffer proxies_;
};

// Many proxies drawn by one call for each shape, each of which marks or counts in a word of a storage buffer what of it
// passes the depth test.

// What a word says in the end, if it was 0.
enum class Marking {
  visible,  // 1 if anything of the proxy passed
  pixels,   // how many passed; of an image with one sample a pixel
};

// A proxy to be drawn, as the shaders read it.
struct MarkedProxy {
  glm::mat4 unit_to_clip{1.0F};  // front faces are counter-clockwise
  std::uint32_t word = 0;        // of the storage buffer
};
static_assert(sizeof(MarkedProxy) == 68);

using MarkedProxies = std::array<std::vector<MarkedProxy>, proxy_shape_count>;  // by shape

// Lives in a context of OpenGL 4.3 that is current in every call.
class ProxyMarks {
 public:
  ProxyMarks(const Functions& gl, Marking marking);
  // Into a buffer that has room for all their words. The state is that of set_proxy_state(). Whoever reads the words
  // does so behind a barrier.
  void draw(const MarkedProxies& proxies, const Buffer& words) const;

 private:
  void upload(const MarkedProxies& proxies) const;

  const Functions* gl_;
  Program program_;
  ProxyBuffer proxies_;
  Buffer instances_;
};

}  // namespace occlod::gl
