// Holds meshes in OpenGL: one static vertex buffer for each mesh, one index buffer for each object and side of the
// picture.
#pragma once

#include <glm/vec4.hpp>
#include <span>

#include "gl/objects.h"
#include "objects.h"
#include "occlod/refiner.h"

namespace occlod::viewer {

// Holds one entry for each vertex. The program takes missing arrays for 0.
struct VertexData {
  std::span<const glm::vec3> positions;
  std::span<const glm::vec3> normals;
  std::span<const std::uint8_t> creases;
  std::span<const glm::u8vec4> colors;
  std::span<const glm::vec2> texture_coordinates = {};
  std::span<const MaterialId> materials = {};
  std::span<const glm::vec2> image_coordinates = {};
};
[[nodiscard]] VertexData vertex_data_of(const ViewMesh& mesh);

class VertexBuffers {
 public:
  explicit VertexBuffers(const gl::Functions& gl);
  // Returns how many bytes it uploads.
  std::size_t fill(const VertexData& vertices, bool is_static);
  // Binds the attributes of MeshProgram.
  void bind() const;
  // Gives the bound vertex array these attributes, with other positions.
  void describe(const gl::Buffer& positions) const;
  [[nodiscard]] bool has_colors() const noexcept { return has_colors_; }

 private:
  const gl::Functions* gl_;
  gl::VertexArray array_;
  gl::Buffer positions_;
  gl::Buffer normals_;
  gl::Buffer colors_;
  gl::Buffer creases_;
  gl::Buffer coordinates_;
  gl::Buffer materials_;
  gl::Buffer image_coordinates_;
  bool has_normals_ = false;
  bool has_creases_ = false;
  bool has_colors_ = false;
  bool has_coordinates_ = false;
  bool has_materials_ = false;
  bool has_image_coordinates_ = false;
};

// Holds the vertices of one object while some of them morph, with positions of its own.
class MorphBuffers {
 public:
  MorphBuffers(const gl::Functions& gl, const VertexBuffers& vertices, std::span<const glm::vec3> positions);
  // Works like MorphedPositions::update(). Returns how many bytes it uploads.
  std::size_t update(std::span<const Geomorph> geomorphs);
  void bind() const;

 private:
  const gl::Functions* gl_;
  gl::VertexArray array_;
  gl::Buffer positions_;
  MorphedPositions morphed_;
};

class TriangleBuffers {
 public:
  explicit TriangleBuffers(const gl::Functions& gl);
  // Returns how many bytes it uploads.
  std::size_t fill(std::span<const Triangle> triangles);
  // Updates a buffer in which only `changes`, ascending, and the size differ from `triangles`. Returns how many bytes
  // it uploads.
  std::size_t change(std::span<const Triangle> triangles, std::span<const TriangleRange> changes);
  // Draws with the vertex buffers and the program bound.
  void draw() const;
  // Draws some of the triangles, which then count from 0 again.
  void draw(const TriangleRange& range) const;

 private:
  const gl::Functions* gl_;
  gl::Buffer indices_;
  std::size_t capacity_ = 0;  // in triangles
  GLsizei index_count_ = 0;
};

// Holds colours of triangles, sRGB.
class TriangleColors {
 public:
  explicit TriangleColors(const gl::Functions& gl);
  // Uploads one colour per triangle, or none. Returns how many bytes it uploads.
  std::size_t fill(std::span<const glm::u8vec4> colors);
  [[nodiscard]] bool any() const noexcept { return any_; }
  void bind() const;  // to texture unit 0, which MeshProgram reads

 private:
  const gl::Functions* gl_;
  gl::Texture texture_;
  int rows_ = 0;
  bool any_ = false;
};

}  // namespace occlod::viewer
