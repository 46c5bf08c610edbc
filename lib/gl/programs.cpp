#include "gl/programs.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <initializer_list>
#include <string>

#include "base/placement.h"

namespace occlod::gl {
namespace {

// Depth bias: this share of the depth that one pixel spans, plus this many steps of the depth buffer.
constexpr float bias_slope = 1.0F / 64.0F;
constexpr float bias_steps = 4.0F;

}  // namespace

void set_surface_state(const Functions& gl) {
  gl.DepthRange(0.0, 1.0);
  gl.Disable(GL_SCISSOR_TEST);
  gl.Disable(GL_STENCIL_TEST);
  gl.Disable(GL_CULL_FACE);
  // Disabled because what the near plane cuts off must not hide anything.
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
  // Enabled because what reaches beyond the far plane must not vanish there.
  gl.Enable(GL_DEPTH_CLAMP);
  gl.DepthFunc(GL_LEQUAL);
  gl.DepthMask(GL_FALSE);
  gl.PolygonOffset(-bias_slope, -bias_steps);
}

namespace {

// Pixels are square, so one factor serves both directions.
glm::dvec2 view_scale(const View& view) {
  return 2.0 * view.focal_length_px() / glm::dvec2(view.width(), view.height());
}

glm::dmat3 world_to_view(const View& view) {
  // Off-centre, clip x and y grow with the distance too.
  const glm::dvec2& principal = view.camera().principal_point;
  const glm::dvec3 x(glm::row(view.world_to_clip(), 0)), y(glm::row(view.world_to_clip(), 1));
  const glm::dvec3 right = glm::normalize(x - principal.x * view.direction());
  const glm::dvec3 up = glm::normalize(y - principal.y * view.direction());
  return glm::transpose(glm::dmat3(right, up, -view.direction()));
}

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

glm::dmat4 view_to_clip(const View& view) {
  const double near = view.camera().near;
  const double far = view.camera().far;
  const glm::dvec2 scale = view_scale(view);
  glm::dmat4 matrix(0.0);
  matrix[0].x = scale.x;
  matrix[1].y = scale.y;
  if (view.is_orthographic()) {
    matrix[2].z = -2.0 / (far - near);
    matrix[3].z = -(far + near) / (far - near);
    matrix[3].w = 1.0;
  } else {
    matrix[2].z = -(far + near) / (far - near);
    matrix[3].z = -2.0 * far * near / (far - near);
    matrix[2] = {-view.camera().principal_point, matrix[2].z, -1.0};
  }
  return matrix;
}

EyeSpace::EyeSpace(const View& view, const glm::dmat4& object_to_world) {
  require_placement(object_to_world);
  const glm::dmat3 linear(object_to_world);
  const glm::dmat3 turn = world_to_view(view);
  // Far from the origin the difference of two places is rounded once, and little; their images under a matrix are not.
  const glm::dvec3 origin = glm::dvec3(object_to_world[3]) - view.camera().eye;
  eye = glm::vec3(glm::inverse(linear) * -origin);
  if (!finite(eye)) eye = glm::vec3(0.0F);
  to_view = glm::mat3(turn * linear);
  offset = glm::vec3(turn * (linear * glm::dvec3(eye) + origin));
  glm::dmat4 object_to_view(turn * linear);
  object_to_view[3] = glm::dvec4(turn * origin, 1.0);
  object_to_clip = view_to_clip(view) * object_to_view;
  mirrored = glm::determinant(linear) < 0.0;
}

namespace {

constexpr const char* vertex_shader = R"(#version 330 core
layout(location = 0) in vec4 position;
uniform mat4 to_clip;
invariant gl_Position;
void main() { gl_Position = to_clip * position; }
)";
constexpr const char* fragment_shader = R"(#version 330 core
void main() {}
)";

}  // namespace

PlainProgram::PlainProgram(const Functions& gl)
    : gl_(&gl),
      program_(gl, {{GL_VERTEX_SHADER, vertex_shader}, {GL_FRAGMENT_SHADER, fragment_shader}}),
      to_clip_(program_.uniform("to_clip")) {}

void PlainProgram::set_to_clip(const glm::mat4& to_clip) const {
  gl_->UniformMatrix4fv(to_clip_, 1, GL_FALSE, glm::value_ptr(to_clip));
}

namespace {

constexpr const char* node_vertex_shader = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 color;
layout(location = 2) in vec3 merged;
layout(location = 3) in float morph;
uniform vec3 eye;
uniform mat3 to_view;
uniform vec3 offset;
uniform mat4 view_to_clip;
out vec3 view_position;
out vec3 linear_color;

// Exactly one or the other at both ends, where parents take over.
vec3 morphed() {
  if (morph <= 0.0) return position;
  return morph >= 1.0 ? merged : mix(position, merged, morph);
}

void main() {
  view_position = to_view * (morphed() - eye) + offset;
  gl_Position = view_to_clip * vec4(view_position, 1.0);
  linear_color = to_linear(color.rgb);
}
)";

// Uses a gamma of 2: where the CPU draws, powers cost more than everything else together.
constexpr const char* plain_encoding = R"(
vec3 to_linear(vec3 srgb) { return srgb * srgb; }
vec3 to_srgb(vec3 linear) { return sqrt(clamp(linear, 0.0, 1.0)); }
)";

// Follows IEC 61966-2-1.
constexpr const char* exact_encoding = R"(
vec3 to_linear(vec3 srgb) {
  return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), greaterThan(srgb, vec3(0.04045)));
}
vec3 to_srgb(vec3 linear) {
  vec3 v = clamp(linear, 0.0, 1.0);
  return mix(12.92 * v, 1.055 * pow(v, vec3(1.0 / 2.4)) - 0.055, greaterThan(v, vec3(0.0031308)));
}
)";

constexpr const char* plain_sky = R"(
vec3 sky(vec3 normal, vec3 to_eye) {
  return mix(vec3(0.045, 0.036, 0.034), vec3(0.12, 0.15, 0.20), 0.5 + 0.5 * normal.y);
}
)";

// Approximates the same light by eight lights with highlights at the corners of a cube.
constexpr const char* dear_sky = R"(
vec3 sky(vec3 normal, vec3 to_eye) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 8; ++i) {
    vec3 light = 0.57735027 * vec3((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0, (i & 4) != 0 ? 1.0 : -1.0);
    float highlight = max(dot(normal, normalize(light + to_eye)), 0.0);
    highlight *= highlight;
    highlight *= highlight;
    highlight *= highlight;
    highlight *= highlight;
    vec3 color = mix(vec3(0.045, 0.036, 0.034), vec3(0.12, 0.15, 0.20), 0.5 + 0.5 * light.y);
    sum += color * (max(dot(normal, light), 0.0) + 0.2 * highlight);
  }
  return 0.5 * sum;
}
)";

constexpr const char* node_fragment_shader = R"(
in vec3 view_position;
in vec3 linear_color;
uniform bool orthographic;
out vec4 target;

void main() {
  vec3 to_eye = orthographic ? vec3(0.0, 0.0, 1.0) : normalize(-view_position);
  vec3 normal = cross(dFdx(view_position), dFdy(view_position));
  normal = dot(normal, normal) > 0.0 ? normalize(normal) : to_eye;
  if (dot(normal, to_eye) < 0.0) normal = -normal;
  float head = dot(normal, to_eye);
  float key = max(dot(normal, normalize(vec3(-0.60, 0.75, 0.45))), 0.0);
  vec3 light = 0.12 * head + 0.98 * key * vec3(1.0, 0.94, 0.84) + sky(normal, to_eye);
  target = vec4(to_srgb(linear_color * light), 1.0);
}
)";

std::string shader(std::initializer_list<const char*> parts) {
  std::string source = "#version 330 core\n";
  for (const char* part : parts) source += part;
  return source;
}

}  // namespace

NodeProgram::NodeProgram(const Functions& gl, bool dear)
    : gl_(&gl),
      program_(gl, {{GL_VERTEX_SHADER, shader({dear ? exact_encoding : plain_encoding, node_vertex_shader}).c_str()},
                    {GL_FRAGMENT_SHADER,
                     shader({dear ? exact_encoding : plain_encoding, dear ? dear_sky : plain_sky, node_fragment_shader})
                         .c_str()}}),
      view_to_clip_(program_.uniform("view_to_clip")),
      orthographic_(program_.uniform("orthographic")),
      eye_(program_.uniform("eye")),
      to_view_(program_.uniform("to_view")),
      offset_(program_.uniform("offset")) {}

void NodeProgram::set_view(const View& view) const {
  const glm::mat4 matrix(view_to_clip(view));
  gl_->UniformMatrix4fv(view_to_clip_, 1, GL_FALSE, glm::value_ptr(matrix));
  gl_->Uniform1i(orthographic_, view.is_orthographic() ? 1 : 0);
}

void NodeProgram::set_object(const EyeSpace& object) const {
  gl_->Uniform3fv(eye_, 1, glm::value_ptr(object.eye));
  gl_->UniformMatrix3fv(to_view_, 1, GL_FALSE, glm::value_ptr(object.to_view));
  gl_->Uniform3fv(offset_, 1, glm::value_ptr(object.offset));
}

}  // namespace occlod::gl
