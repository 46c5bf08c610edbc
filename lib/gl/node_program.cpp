#include "gl/node_program.h"

#include <glm/gtc/type_ptr.hpp>
#include <initializer_list>
#include <string>

namespace occlod::gl {
namespace {

constexpr const char* vertex_shader = R"(
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

// With a gamma of 2: where the CPU draws, powers cost more than everything else together.
constexpr const char* plain_encoding = R"(
vec3 to_linear(vec3 srgb) { return srgb * srgb; }
vec3 to_srgb(vec3 linear) { return sqrt(clamp(linear, 0.0, 1.0)); }
)";

// IEC 61966-2-1.
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

// About the same light, as eight lights with highlights at the corners of a cube.
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

constexpr const char* fragment_shader = R"(
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
      program_(
          gl,
          {{GL_VERTEX_SHADER, shader({dear ? exact_encoding : plain_encoding, vertex_shader}).c_str()},
           {GL_FRAGMENT_SHADER,
            shader({dear ? exact_encoding : plain_encoding, dear ? dear_sky : plain_sky, fragment_shader}).c_str()}}),
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
