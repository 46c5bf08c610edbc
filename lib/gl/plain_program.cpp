#include "gl/plain_program.h"

#include <glm/gtc/type_ptr.hpp>

namespace occlod::gl {
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

}  // namespace occlod::gl
