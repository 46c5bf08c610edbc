#include "gl/proxy_marks.h"

#include <span>

namespace occlod::gl {
namespace {

// As PlainProgram does it, to the bit.
constexpr const char* vertex_source = R"(#version 430 core
layout(location = 0) in vec4 position;
layout(location = 1) in mat4 to_clip;
layout(location = 5) in uint word;
flat out uint marked;
invariant gl_Position;
void main() {
  gl_Position = to_clip * position;
  marked = word;
}
)";

// Front faces of a convex proxy cover each pixel once, so additions are pixels.
constexpr const char* mark_source = R"(#version 430 core
layout(early_fragment_tests) in;
layout(std430, binding = 0) buffer Marks { uint marks[]; };
flat in uint marked;
void main() { if (marks[marked] == 0u) marks[marked] = 1u; }
)";
constexpr const char* count_source = R"(#version 430 core
layout(early_fragment_tests) in;
layout(std430, binding = 0) buffer Marks { uint marks[]; };
flat in uint marked;
void main() { atomicAdd(marks[marked], 1u); }
)";

}  // namespace

ProxyMarks::ProxyMarks(const Functions& gl, Marking marking)
    : gl_(&gl),
      program_(gl, {{GL_VERTEX_SHADER, vertex_source},
                    {GL_FRAGMENT_SHADER, marking == Marking::visible ? mark_source : count_source}}),
      proxies_(gl),
      instances_(gl) {
  proxies_.bind(gl);
  gl.BindBuffer(GL_ARRAY_BUFFER, instances_.id());
  const auto attribute = [](std::size_t offset) {
    return reinterpret_cast<const void*>(offset);  // NOLINT(performance-no-int-to-ptr)
  };
  for (GLuint column = 0; column < 4; ++column) {
    gl.EnableVertexAttribArray(1 + column);
    gl.VertexAttribPointer(1 + column, 4, GL_FLOAT, GL_FALSE, sizeof(MarkedProxy),
                           attribute(column * sizeof(glm::vec4)));
    gl.VertexAttribDivisor(1 + column, 1);
  }
  gl.EnableVertexAttribArray(5);
  gl.VertexAttribIPointer(5, 1, GL_UNSIGNED_INT, sizeof(MarkedProxy), attribute(offsetof(MarkedProxy, word)));
  gl.VertexAttribDivisor(5, 1);
  check(gl, "set-up of marks");
}

void ProxyMarks::upload(const MarkedProxies& proxies) const {
  std::size_t count = 0;
  for (const auto& of_shape : proxies) count += of_shape.size();
  gl_->BindBuffer(GL_ARRAY_BUFFER, instances_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(MarkedProxy)), nullptr, GL_STREAM_DRAW);
  std::size_t first = 0;
  for (const auto& of_shape : proxies) {
    if (of_shape.empty()) continue;
    gl_->BufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(first * sizeof(MarkedProxy)),
                       static_cast<GLsizeiptr>(of_shape.size() * sizeof(MarkedProxy)), of_shape.data());
    first += of_shape.size();
  }
}

void ProxyMarks::draw(const MarkedProxies& proxies, const Buffer& words) const {
  upload(proxies);
  gl_->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, words.id());
  gl_->UseProgram(program_.id());
  proxies_.bind(*gl_);
  std::size_t first = 0;
  for (std::size_t i = 0; i < proxy_shape_count; ++i) {
    if (proxies[i].empty()) continue;
    const ProxyBuffer::Part& part = proxies_.part(static_cast<ProxyShape>(i));
    gl_->DrawElementsInstancedBaseInstance(GL_TRIANGLES, part.count, GL_UNSIGNED_SHORT, part.pointer(),
                                           static_cast<GLsizei>(proxies[i].size()), static_cast<GLuint>(first));
    first += proxies[i].size();
  }
}

}  // namespace occlod::gl
