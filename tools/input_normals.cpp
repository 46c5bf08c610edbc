#include "input_normals.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <tuple>

#include "occlod/build_hlod.h"

namespace occlod::tool {
namespace {

auto key(const glm::vec3& p) { return std::tuple(p.x, p.y, p.z); }

}  // namespace

InputNormals::InputNormals(std::span<const hlod::PlacedHlod> placed) {
  for (const hlod::PlacedHlod& object : placed) {
    const hlod::Hlod& hlod = *object.hlod;
    const hlod::Level& finest = hlod.data().levels[0];
    std::vector<Entry>& entries = entries_.emplace_back();
    for (hlod::NodeId n = finest.first_node; n < finest.first_node + finest.node_count; ++n) {
      if (hlod.node(n).triangles == 0) continue;
      const hlod::NodeMesh mesh = hlod.mesh(n);
      const std::size_t first = entries.size();
      for (const glm::vec3& p : mesh.positions) entries.push_back({p, glm::vec3(0.0F)});
      for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const auto corner = [&](std::size_t k) -> const glm::vec3& { return mesh.positions[mesh.indices[i + k]]; };
        const glm::vec3 normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
        for (std::size_t k = 0; k < 3; ++k) entries[first + mesh.indices[i + k]].normal += normal;
      }
    }
    std::ranges::stable_sort(entries, {}, [](const Entry& e) { return key(e.position); });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (kept > 0 && entries[kept - 1].position == entries[i].position)
        entries[kept - 1].normal += entries[i].normal;
      else
        entries[kept++] = entries[i];
    }
    entries.resize(kept);
  }
}

glm::dvec3 InputNormals::at(std::size_t object, const glm::vec3& position) const {
  const std::vector<Entry>& entries = entries_[object];
  const auto found =
      std::ranges::lower_bound(entries, key(position), {}, [](const Entry& e) { return key(e.position); });
  if (found == entries.end() || found->position != position) return glm::dvec3(0.0);
  const glm::dvec3 normal(found->normal);
  const double length = glm::length(normal);
  return length > 0.0 ? normal / length : glm::dvec3(0.0);
}

}  // namespace occlod::tool
