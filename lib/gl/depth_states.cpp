#include "gl/depth_states.h"

namespace occlod::gl {
namespace {

// By this much of the depth that one pixel spans, and so many steps of the depth buffer.
constexpr float bias_slope = 1.0F / 64.0F;
constexpr float bias_steps = 4.0F;

}  // namespace

void set_surface_state(const Functions& gl) {
  gl.DepthRange(0.0, 1.0);
  gl.Disable(GL_SCISSOR_TEST);
  gl.Disable(GL_STENCIL_TEST);
  gl.Disable(GL_CULL_FACE);
  // What the near plane cuts off must not hide anything.
  gl.Disable(GL_DEPTH_CLAMP);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LESS);
  gl.DepthMask(GL_TRUE);
  gl.Enable(GL_POLYGON_OFFSET_FILL);
  gl.PolygonOffset(bias_slope, bias_steps);
}

void set_proxy_state(const Functions& gl) {
  gl.Enable(GL_CULL_FACE);
  gl.CullFace(GL_BACK);
  gl.FrontFace(GL_CCW);
  // What reaches beyond the far plane must not vanish there.
  gl.Enable(GL_DEPTH_CLAMP);
  gl.DepthFunc(GL_LEQUAL);
  gl.DepthMask(GL_FALSE);
  gl.PolygonOffset(-bias_slope, -bias_steps);
}

}  // namespace occlod::gl
