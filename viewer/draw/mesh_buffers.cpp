#include "mesh_buffers.h"

#include <algorithm>

#include "mesh_program.h"

namespace occlod::viewer {
namespace {

// Of the buffer that is bound.
void attribute(const gl::Functions& gl, GLuint location, GLint size, GLenum type) {
  gl.EnableVertexAttribArray(location);
  gl.VertexAttribPointer(location, size, type, type == GL_UNSIGNED_BYTE ? GL_TRUE : GL_FALSE, 0, nullptr);
}

template <class T>
void store(const gl::Functions& gl, const gl::Buffer& buffer, std::span<const T> data, GLenum usage) {
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer.id());
  gl::fill(gl, GL_ARRAY_BUFFER, data, usage);
}

}  // namespace

VertexBuffers::VertexBuffers(const gl::Functions& gl, const ViewMesh& mesh)
    : gl_(&gl),
      array_(gl),
      positions_(gl),
      normals_(gl),
      colors_(gl),
      has_colors_(!mesh.hierarchy->data().colors.empty()) {
  gl.BindVertexArray(array_.id());
  store(gl, positions_, mesh.hierarchy->positions(), GL_STATIC_DRAW);
  attribute(gl, 0, 3, GL_FLOAT);
  store(gl, normals_, std::span<const glm::vec3>(mesh.normals), GL_STATIC_DRAW);
  attribute(gl, 1, 3, GL_FLOAT);
  if (!has_colors_) return;
  store(gl, colors_, mesh.hierarchy->data().colors, GL_STATIC_DRAW);
  attribute(gl, 2, 4, GL_UNSIGNED_BYTE);
}

void VertexBuffers::bind() const { gl_->BindVertexArray(array_.id()); }

TriangleBuffers::TriangleBuffers(const gl::Functions& gl) : gl_(&gl), indices_(gl) {}

void TriangleBuffers::fill(std::span<const Triangle> triangles) {
  gl_->BindVertexArray(0);  // whose index buffer this would become
  store(*gl_, indices_, triangles, GL_STREAM_DRAW);
  index_count_ = static_cast<GLsizei>(3 * triangles.size());
}

void TriangleBuffers::draw() const {
  gl_->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl_->DrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

TriangleColors::TriangleColors(const gl::Functions& gl) : gl_(&gl), texture_(gl) {
  gl.BindTexture(GL_TEXTURE_2D, texture_.id());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void TriangleColors::fill(std::span<const glm::u8vec4> colors) {
  any_ = !colors.empty();
  if (!any_) return;
  constexpr int a_row = MeshProgram::texels_a_row;
  const int full_rows = static_cast<int>(colors.size() / a_row);
  const int rest = static_cast<int>(colors.size() % a_row);
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  gl_->BindTexture(GL_TEXTURE_2D, texture_.id());
  if (full_rows + 1 > rows_) {
    rows_ = full_rows + 1;
    gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, a_row, rows_, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  }
  if (full_rows > 0)
    gl_->TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, a_row, full_rows, GL_RGBA, GL_UNSIGNED_BYTE, colors.data());
  if (rest > 0)
    gl_->TexSubImage2D(GL_TEXTURE_2D, 0, 0, full_rows, rest, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                       colors.data() + static_cast<std::size_t>(full_rows) * a_row);
}

void TriangleColors::bind() const {
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, texture_.id());
}

}  // namespace occlod::viewer
