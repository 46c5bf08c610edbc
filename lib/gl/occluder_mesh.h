// The occluder of one view as a single indexed mesh in clip space.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "gl/objects.h"
#include "occlod/refine/visibility.h"

namespace occlod::gl {

// Only the vertices that some triangle uses, each once, transformed in double precision: the product of a matrix and a
// point close to the eye cancels, and single precision would move the occluder there. An occluder uses few of its
// object's vertices, so streaming them costs less than telling whether a copy of them all on the GPU is still the same.
// Reuses its memory. No OpenGL here.
class OccluderMesh {
 public:
  // object_to_clip by object. O(triangles), and O(vertices) the first time that a part is so large.
  void assign(std::span<const OccluderPart> parts, std::span<const glm::dmat4> object_to_clip);

  [[nodiscard]] std::span<const glm::vec4> vertices() const noexcept { return vertices_; }  // clip space
  [[nodiscard]] std::span<const std::uint32_t> indices() const noexcept { return indices_; }

 private:
  void append(const OccluderPart& part, const glm::dmat4& object_to_clip);

  std::vector<glm::vec4> vertices_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint32_t> slots_;  // of a part's vertices in vertices_; all no_id between calls
};

// The same on its way to OpenGL: positions at location 0, in clip space.
class OccluderBuffer {
 public:
  explicit OccluderBuffer(const Functions& gl);
  void draw(const Functions& gl, const OccluderMesh& mesh) const;

 private:
  VertexArray array_;
  Buffer vertices_;
  Buffer indices_;
};

}  // namespace occlod::gl
