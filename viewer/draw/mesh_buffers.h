// Meshes in OpenGL: one static vertex buffer for each mesh, one index buffer for each object and refinement.
#pragma once

#include <glm/vec4.hpp>
#include <span>

#include "gl/objects.h"
#include "objects.h"

namespace occlod::viewer {

class VertexBuffers {
 public:
  VertexBuffers(const gl::Functions& gl, const ViewMesh& mesh);
  // Binds the attributes of MeshProgram.
  void bind() const;
  [[nodiscard]] bool has_colors() const noexcept { return has_colors_; }

 private:
  const gl::Functions* gl_;
  gl::VertexArray array_;
  gl::Buffer positions_;
  gl::Buffer normals_;
  gl::Buffer colors_;
  bool has_colors_;
};

class TriangleBuffers {
 public:
  explicit TriangleBuffers(const gl::Functions& gl);
  void fill(std::span<const Triangle> triangles);
  // With the vertex buffers and the program bound.
  void draw() const;

 private:
  const gl::Functions* gl_;
  gl::Buffer indices_;
  GLsizei index_count_ = 0;
};

// Colours of triangles, sRGB.
class TriangleColors {
 public:
  explicit TriangleColors(const gl::Functions& gl);
  // One for each triangle, or none.
  void fill(std::span<const glm::u8vec4> colors);
  [[nodiscard]] bool any() const noexcept { return any_; }
  void bind() const;  // to texture unit 0, as MeshProgram reads them

 private:
  const gl::Functions* gl_;
  gl::Texture texture_;
  int rows_ = 0;
  bool any_ = false;
};

}  // namespace occlod::viewer
