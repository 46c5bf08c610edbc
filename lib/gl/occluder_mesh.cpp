#include "gl/occluder_mesh.h"

#include <cassert>

#include "occlod/core/ids.h"

namespace occlod::gl {

void OccluderMesh::assign(std::span<const OccluderPart> parts, std::span<const glm::dmat4> object_to_clip) {
  vertices_.clear();
  indices_.clear();
  for (const OccluderPart& part : parts) {
    assert(part.object < object_to_clip.size());
    append(part, object_to_clip[part.object]);
  }
}

void OccluderMesh::append(const OccluderPart& part, const glm::dmat4& object_to_clip) {
  if (slots_.size() < part.positions.size()) slots_.resize(part.positions.size(), no_id);
  for (const Triangle& triangle : part.triangles) {
    for (int k = 0; k < 3; ++k) {
      const VertexId v = triangle[k];
      assert(v < part.positions.size());
      if (slots_[v] == no_id) {
        slots_[v] = static_cast<std::uint32_t>(vertices_.size());
        vertices_.emplace_back(object_to_clip * glm::dvec4(part.positions[v], 1.0));
      }
      indices_.push_back(slots_[v]);
    }
  }
  for (const Triangle& triangle : part.triangles)
    for (int k = 0; k < 3; ++k) slots_[triangle[k]] = no_id;
}

OccluderBuffer::OccluderBuffer(const Functions& gl) : array_(gl), vertices_(gl), indices_(gl) {
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  gl.EnableVertexAttribArray(0);
  gl.VertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 0, nullptr);
}

void OccluderBuffer::draw(const Functions& gl, const OccluderMesh& mesh) const {
  if (mesh.indices().empty()) return;
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  fill(gl, GL_ARRAY_BUFFER, mesh.vertices(), GL_STREAM_DRAW);
  fill(gl, GL_ELEMENT_ARRAY_BUFFER, mesh.indices(), GL_STREAM_DRAW);
  gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.indices().size()), GL_UNSIGNED_INT, nullptr);
}

}  // namespace occlod::gl
