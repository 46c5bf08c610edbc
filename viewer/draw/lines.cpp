#include "lines.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>

namespace occlod::viewer {
namespace {

constexpr const char* vertex_shader = R"(#version 330 core
layout(location = 0) in vec4 clip;
layout(location = 1) in vec4 color;
layout(location = 2) in float hidden_alpha;
uniform bool hidden;
out vec4 pen;
void main() {
  gl_Position = clip;
  pen = vec4(color.rgb, color.a * (hidden ? hidden_alpha : 1.0));
}
)";

constexpr const char* fragment_shader = R"(#version 330 core
in vec4 pen;
out vec4 target;
void main() { target = pen; }
)";

// Cuts off what is not ahead of the eye by this distance. Returns false when nothing is left.
bool clip_to_eye(glm::dvec4& a, glm::dvec4& b, double min_w) {
  const double ahead_a = a.w - min_w;
  const double ahead_b = b.w - min_w;
  if (ahead_a <= 0.0 && ahead_b <= 0.0) return false;
  if (ahead_a < 0.0) a = glm::mix(a, b, ahead_a / (ahead_a - ahead_b));
  if (ahead_b < 0.0) b = glm::mix(b, a, ahead_b / (ahead_b - ahead_a));
  return true;
}

}  // namespace

LineDrawing::LineDrawing(const gl::Functions& gl)
    : gl_(&gl),
      program_(gl, {{GL_VERTEX_SHADER, vertex_shader}, {GL_FRAGMENT_SHADER, fragment_shader}}),
      hidden_(program_.uniform("hidden")),
      array_(gl),
      buffer_(gl) {
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer_.id());
  const auto attribute = [&](GLuint location, GLint size, std::size_t offset) {
    gl.EnableVertexAttribArray(location);
    gl.VertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                           reinterpret_cast<const void*>(offset));  // NOLINT(performance-no-int-to-ptr): OpenGL's way
  };
  attribute(0, 4, offsetof(Vertex, clip));
  attribute(1, 4, offsetof(Vertex, color));
  attribute(2, 1, offsetof(Vertex, hidden_alpha));
}

// Appends a strip of the pen's width, as two triangles.
void LineDrawing::append(const Line& line, const View& view) {
  glm::dvec4 a = view.world_to_clip() * glm::dvec4(line.a, 1.0);
  glm::dvec4 b = view.world_to_clip() * glm::dvec4(line.b, 1.0);
  if (!view.is_orthographic() && !clip_to_eye(a, b, 1e-3 * view.camera().near)) return;  // no eye if orthographic
  const glm::dvec2 half_size = glm::dvec2(view.width(), view.height()) / 2.0;
  const glm::dvec2 along = (glm::dvec2(b) / b.w - glm::dvec2(a) / a.w) * half_size;
  const double length = glm::length(along);
  if (!(length > 0.0)) return;
  const glm::dvec2 aside = glm::dvec2(-along.y, along.x) * (line.pen.width_px / (2.0 * length)) / half_size;
  const auto vertex = [&](const glm::dvec4& p, double side) {
    return Vertex{glm::vec4(p + glm::dvec4(side * p.w * aside, 0.0, 0.0)), line.pen.color,
                  static_cast<float>(line.pen.hidden_alpha)};
  };
  const Vertex corners[] = {vertex(a, -1.0), vertex(a, 1.0), vertex(b, 1.0), vertex(b, -1.0)};
  for (const int i : {0, 1, 2, 0, 2, 3}) vertices_.push_back(corners[i]);
}

void LineDrawing::draw(const std::vector<Line>& lines, const View& view) {
  vertices_.clear();
  for (const Line& line : lines) append(line, view);
  if (vertices_.empty()) return;
  const gl::Functions& gl = *gl_;
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer_.id());
  gl::fill(gl, GL_ARRAY_BUFFER, std::span<const Vertex>(vertices_), GL_STREAM_DRAW);
  gl.UseProgram(program_.id());
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl.DepthMask(GL_FALSE);
  gl.Enable(GL_DEPTH_CLAMP);  // the planes contain the scene, which the frustum exceeds
  const auto count = static_cast<GLsizei>(vertices_.size());
  gl.Disable(GL_DEPTH_TEST);
  gl.Uniform1i(hidden_, 1);
  gl.DrawArrays(GL_TRIANGLES, 0, count);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LEQUAL);
  gl.Uniform1i(hidden_, 0);
  gl.DrawArrays(GL_TRIANGLES, 0, count);
  gl.Disable(GL_DEPTH_CLAMP);
  gl.DepthMask(GL_TRUE);
  gl.Disable(GL_BLEND);
}

}  // namespace occlod::viewer
