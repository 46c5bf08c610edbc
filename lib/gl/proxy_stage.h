// Builds the occluder of one view as a single indexed mesh in clip space.
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

// Contains only the vertices that some triangle uses, each once, transformed in double precision: the product of a
// matrix and a point close to the eye suffers from cancellation, and single precision would move the occluder there. An
// occluder uses few of its object's vertices, so streaming them costs less than checking whether a copy of all of them
// on the GPU is still current. Reuses its memory. Does not call OpenGL.
class OccluderMesh {
 public:
  // Replaces the mesh. `object_to_clip` is indexed by object. O(triangles), plus O(vertices) when a part is larger than
  // all before.
  void assign(std::span<const OccluderPart> parts, std::span<const glm::dmat4> object_to_clip);

  [[nodiscard]] std::span<const glm::vec4> vertices() const noexcept { return vertices_; }  // clip space
  [[nodiscard]] std::span<const std::uint32_t> indices() const noexcept { return indices_; }

 private:
  void append(const OccluderPart& part, const glm::dmat4& object_to_clip);

  std::vector<glm::vec4> vertices_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint32_t> slots_;  // index in vertices_ of each vertex of a part; all no_id between calls
};

// Uploads an OccluderMesh to OpenGL: positions at location 0, in clip space.
class OccluderBuffer {
 public:
  explicit OccluderBuffer(const Functions& gl);
  void draw(const Functions& gl, const OccluderMesh& mesh) const;

 private:
  VertexArray array_;
  Buffer vertices_;
  Buffer indices_;
};

// Draws the occluder into a depth buffer and tests proxies against it; gl-query and gl-mark share it.

// Lives in a context that must be current in every call. After begin_view and draw_occluder the target is bound and the
// state is set for drawing front faces of proxies, with depth test and without depth writes. All state that the draws
// depend on is set there, so other code may use the context between views.
class ProxyStage {
 public:
  // With a `divisor`, the target has one sample for divisor x divisor pixels, at the farthest depth that the occluder
  // has there.
  ProxyStage(const Functions& gl, int divisor);

  void begin_view(const View& view, std::span<const ObjectView> objects);
  void draw_occluder(std::span<const OccluderPart> parts);

  [[nodiscard]] const Functions& gl() const noexcept { return *gl_; }
  [[nodiscard]] const ProxyBuffer& proxies() const noexcept { return proxies_; }
  [[nodiscard]] QueryPlan plan(const VisibilityQuery& query) const;
  // Returns the answer to a query that is not drawn; with `counts`, all pixels where nothing is known.
  [[nodiscard]] std::uint32_t answer(const QueryPlan& plan, bool counts) const;
  // Converts samples of the target that passed to pixels of the view; max_pixels as in ProxyDraw.
  [[nodiscard]] std::uint32_t pixels(std::uint32_t samples, std::uint32_t max_pixels) const;
  // Draws one proxy on its own.
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
  std::optional<FloatTarget> reduced_;  // when the divisor is above 1
  PlainProgram plain_;
  std::optional<Program> reduction_;
  VertexArray nothing_;  // OpenGL draws nothing without a vertex array, even without attributes
  OccluderBuffer occluder_;
  ProxyBuffer proxies_;
};

// Draws many proxies by one call per shape; each marks or counts, in a word of a storage buffer, the pixels that pass
// the depth test.

// Defines what a word contains after drawing, if it was 0 before.
enum class Marking {
  visible,  // 1 if any pixel of the proxy passed
  pixels,   // number of pixels that passed, in an image with one sample per pixel
};

// Describes a drawn proxy as the shaders read it.
struct MarkedProxy {
  glm::mat4 unit_to_clip{1.0F};  // front faces are counter-clockwise
  std::uint32_t word = 0;        // index into the storage buffer
};
static_assert(sizeof(MarkedProxy) == 68);

using MarkedProxies = std::array<std::vector<MarkedProxy>, proxy_shape_count>;  // by shape

// Lives in a context of OpenGL 4.3 that must be current in every call.
class ProxyMarks {
 public:
  ProxyMarks(const Functions& gl, Marking marking);
  // Draws into a buffer that has room for all words. Requires the state of set_proxy_state(). Readers of the words need
  // a barrier first.
  void draw(const MarkedProxies& proxies, const Buffer& words) const;

 private:
  void upload(const MarkedProxies& proxies) const;

  const Functions* gl_;
  Program program_;
  ProxyBuffer proxies_;
  Buffer instances_;
};

}  // namespace occlod::gl
