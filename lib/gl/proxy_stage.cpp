#include "gl/proxy_stage.h"

#include <algorithm>
#include <cassert>

#include "hlod/draw/clip_matrix.h"
#include "gl/depth_states.h"

namespace occlod::gl {
namespace {

// A triangle over the whole target, whose every sample takes the farthest depth of its pixels.
constexpr const char* reduction_vertex = R"(#version 330 core
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }
)";
constexpr const char* reduction_fragment = R"(#version 330 core
uniform sampler2D depth;
uniform int divisor;
void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * divisor;
  ivec2 end = min(first + divisor, textureSize(depth, 0));
  float farthest = 0.0;
  for (int y = first.y; y < end.y; ++y)
    for (int x = first.x; x < end.x; ++x) farthest = max(farthest, texelFetch(depth, ivec2(x, y), 0).r);
  gl_FragDepth = farthest;
}
)";

}  // namespace

ProxyStage::ProxyStage(const Functions& gl, int divisor)
    : gl_(&gl),
      divisor_(divisor),
      full_(gl, FloatTarget::Kind::depth),
      plain_(gl),
      nothing_(gl),
      occluder_(gl),
      proxies_(gl) {
  if (divisor > 1) {
    reduced_.emplace(gl, FloatTarget::Kind::depth);
    reduction_.emplace(gl, std::initializer_list<ShaderSource>{{GL_VERTEX_SHADER, reduction_vertex},
                                                               {GL_FRAGMENT_SHADER, reduction_fragment}});
  }
  check(gl, "set-up of proxies");
}

void ProxyStage::begin_view(const View& view, std::span<const ObjectView> objects) {
  screen_ = Screen(view, divisor_);
  object_to_clip_ = clip_matrices(view.camera(), objects);
  spaces_.clear();
  for (std::size_t i = 0; i < objects.size(); ++i)
    spaces_.emplace_back(screen_, object_to_clip_[i], objects[i].mirrored());
  bind_target();
  start_occluder();
  start_proxies();
  check(gl(), "start of a view");
}

void ProxyStage::draw_occluder(std::span<const OccluderPart> parts) {
  mesh_.assign(parts, object_to_clip_);
  full_.bind(screen_.width, screen_.height);
  gl().Viewport(0, 0, screen_.width, screen_.height);
  start_occluder();
  plain_.set_to_clip(glm::mat4(1.0F));
  occluder_.draw(gl(), mesh_);
  if (reduced_) reduce();
  start_proxies();
  check(gl(), "drawing an occluder");
}

void ProxyStage::bind_target() {
  (reduced_ ? *reduced_ : full_).bind(screen_.target_width(), screen_.target_height());
  gl().Viewport(0, 0, screen_.target_width(), screen_.target_height());
}

void ProxyStage::start_occluder() const {
  set_surface_state(gl());
  plain_.use();
  gl().ClearDepth(1.0);
  gl().Clear(GL_DEPTH_BUFFER_BIT);
}

void ProxyStage::reduce() {
  bind_target();
  gl().UseProgram(reduction_->id());
  gl().ActiveTexture(GL_TEXTURE0);
  gl().BindTexture(GL_TEXTURE_2D, full_.texture());
  gl().Uniform1i(reduction_->uniform("depth"), 0);
  gl().Uniform1i(reduction_->uniform("divisor"), divisor_);
  gl().DepthFunc(GL_ALWAYS);
  gl().BindVertexArray(nothing_.id());
  gl().DrawArrays(GL_TRIANGLES, 0, 3);
  gl().BindTexture(GL_TEXTURE_2D, 0);
  plain_.use();
}

void ProxyStage::start_proxies() const {
  proxies_.bind(gl());
  set_proxy_state(gl());
}

QueryPlan ProxyStage::plan(const VisibilityQuery& query) const {
  assert(query.object < spaces_.size());
  return plan_query(screen_, spaces_[query.object], query);
}

std::uint32_t ProxyStage::answer(const QueryPlan& plan, bool counts) const {
  if (!plan.visible) return 0;
  return counts ? static_cast<std::uint32_t>(screen_.width) * static_cast<std::uint32_t>(screen_.height) : 1;
}

std::uint32_t ProxyStage::pixels(std::uint32_t samples, std::uint32_t most_pixels) const {
  const std::uint64_t pixels = std::uint64_t{samples} * static_cast<std::uint64_t>(divisor_ * divisor_);
  // llvmpipe has been seen to count some 60,000 too many, so a count is believed only as far as the proxy reaches.
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(pixels, most_pixels));
}

void ProxyStage::draw(const ProxyDraw& draw) const {
  const ProxyBuffer::Part& part = proxies_.part(draw.shape);
  plain_.set_to_clip(draw.unit_to_clip);
  gl().DrawElements(GL_TRIANGLES, part.count, GL_UNSIGNED_SHORT, part.pointer());
}

}  // namespace occlod::gl
