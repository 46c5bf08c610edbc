#include "gl/occluder_mesh.h"

#include <cassert>

#include "occlod/core/ids.h"

namespace occlod::gl {

void OccluderMesh::assign(std::span<const OccluderPart> parts, std::span<const ProxySpace> objects) {
  vertices_.clear();
  indices_.clear();
  for (const OccluderPart& part : parts) {
    assert(part.object < objects.size());
    append(part, objects[part.object].object_to_clip);
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

}  // namespace occlod::gl
