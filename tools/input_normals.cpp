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
  std::size_t vertices = 0;
  for (const hlod::Node& node : hlod.data().nodes) vertices += node.vertices;
  slots_.resize(std::bit_ceil(2 * vertices + 1));
  const std::span<const hlod::Level> levels = hlod.data().levels;
  for (hlod::NodeId n = levels[0].first_node; n < levels[0].first_node + levels[0].node_count; ++n)
    add_corners(hlod, n);
  for (std::size_t level = 0; level + 1 < levels.size(); ++level) add_moved(hlod, levels[level]);
}

void InputNormals::Table::add_corners(const hlod::Hlod& hlod, hlod::NodeId n) {
  if (hlod.node(n).triangles == 0) return;
  hlod.require(n);
  const hlod::NodeMesh mesh = hlod.mesh(n);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const auto corner = [&](std::size_t k) -> const glm::vec3& { return mesh.positions[mesh.indices[i + k]]; };
    const glm::vec3 normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    for (std::size_t k = 0; k < 3; ++k) at(corner(k)).normal += normal;
  }
}

// Gives vertices of the next level that are where no vertex was the normals of the nearest that slide to them.
void InputNormals::Table::add_moved(const hlod::Hlod& hlod, const hlod::Level& level) {
  const std::size_t known = entries_.size();
  for (hlod::NodeId n = level.first_node; n < level.first_node + level.node_count; ++n) {
    if (hlod.node(n).triangles == 0) continue;
    hlod.require(n);
    const hlod::NodeMesh mesh = hlod.mesh(n);
    std::vector<bool> is_added(mesh.positions.size(), false);
    for (const hlod::Patch& patch : hlod.patches(n)) {
      if (patch.parent == no_id) continue;
      hlod.require(patch.parent);
      const hlod::NodeMesh parent = hlod.mesh(patch.parent);
      for (const std::uint16_t v : mesh.indices.subspan(patch.first_index, patch.index_count)) {
        const std::uint16_t into = mesh.merged_into[v];
        if (into == hlod::stays || is_added[v]) continue;
        is_added[v] = true;
        const std::uint32_t found = slots_[slot(parent.positions[into])];
        if (found > 0 && found <= known) continue;
        const glm::vec3 step = parent.positions[into] - mesh.positions[v], normal = at(mesh.positions[v]).normal;
        const float distance2 = glm::dot(step, step);
        if (Entry& entry = at(parent.positions[into]); found == 0 || distance2 < entry.distance2)
          entry = {parent.positions[into], normal, distance2};
      }
    }
  }
}

InputNormals::Table::Entry& InputNormals::Table::at(const glm::vec3& position) {
  std::uint32_t& found = slots_[slot(position)];
  if (found == 0) {
    entries_.push_back({position, glm::vec3(0.0F)});
    found = static_cast<std::uint32_t>(entries_.size());
  }
  return entries_[found - 1];
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
