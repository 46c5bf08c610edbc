#include "input_normals.h"

#include <xxhash.h>

#include <bit>
#include <glm/geometric.hpp>

#include "occlod/build_hlod.h"

namespace occlod::tool {

InputNormals::InputNormals(std::span<const hlod::PlacedHlod> placed) {
  for (const hlod::PlacedHlod& object : placed) tables_.emplace_back(*object.hlod);
}

glm::dvec3 InputNormals::at(std::size_t object, const glm::vec3& position) const {
  const glm::vec3* const sum = tables_[object].find(position);
  const glm::dvec3 normal(sum != nullptr ? *sum : glm::vec3(0.0F));
  const double length = glm::length(normal);
  return length > 0.0 ? normal / length : glm::dvec3(0.0);
}

InputNormals::Table::Table(const hlod::Hlod& hlod) {
  const hlod::Level& finest = hlod.data().levels[0];
  const hlod::NodeId end = finest.first_node + finest.node_count;
  std::size_t vertices = 0;
  for (hlod::NodeId n = finest.first_node; n < end; ++n)
    if (hlod.node(n).triangles > 0) vertices += hlod.mesh(n).positions.size();
  slots_.resize(std::bit_ceil(2 * vertices + 1));
  for (hlod::NodeId n = finest.first_node; n < end; ++n) {
    if (hlod.node(n).triangles == 0) continue;
    const hlod::NodeMesh mesh = hlod.mesh(n);
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const auto corner = [&](std::size_t k) -> const glm::vec3& { return mesh.positions[mesh.indices[i + k]]; };
      const glm::vec3 normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& found = slots_[slot(corner(k))];
        if (found == 0) {
          entries_.push_back({corner(k), glm::vec3(0.0F)});
          found = static_cast<std::uint32_t>(entries_.size());
        }
        entries_[found - 1].normal += normal;
      }
    }
  }
}

const glm::vec3* InputNormals::Table::find(const glm::vec3& position) const {
  const std::uint32_t found = slots_[slot(position)];
  return found > 0 ? &entries_[found - 1].normal : nullptr;
}

// Returns where the position is, or would be.
std::size_t InputNormals::Table::slot(const glm::vec3& position) const {
  const std::size_t last = slots_.size() - 1;
  std::size_t i = XXH3_64bits(&position, sizeof(position)) & last;
  while (slots_[i] > 0 && entries_[slots_[i] - 1].position != position) i = (i + 1) & last;
  return i;
}

}  // namespace occlod::tool
