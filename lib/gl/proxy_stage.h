// The occluder in a depth buffer and the proxies before it: what gl-query and gl-mark share.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gl/objects.h"
#include "gl/occluder_mesh.h"
#include "gl/plain_program.h"
#include "gl/proxies.h"
#include "gl/proxy_buffer.h"
#include "occlod/refine/visibility.h"

namespace occlod::gl {

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
  // Pixels of the view from samples of the target that passed; most_pixels as in ProxyDraw.
  [[nodiscard]] std::uint32_t pixels(std::uint32_t samples, std::uint32_t most_pixels) const;
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

}  // namespace occlod::gl
