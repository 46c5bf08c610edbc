#include "hlod/draw/morphed_positions.h"

#include <algorithm>

namespace occlod::hlod {
namespace {

// Returns the part of a range that lies in one patch.
DrawRange shared_part(const DrawRange& range, const Patch& patch) {
  const std::uint32_t first = std::max(range.first_index, patch.first_index);
  const std::uint32_t end = std::min(range.first_index + range.index_count, patch.first_index + patch.index_count);
  return {first, end > first ? end - first : 0, range.morph};
}

// Interpolates exactly at both ends.
glm::vec3 between(const glm::vec3& from, const glm::vec3& to, float morph) {
  return from * (1.0F - morph) + to * morph;
}

void morph_patch(const NodeMesh& mesh, const NodeMesh& parent, const DrawRange& part,
                 std::vector<glm::vec3>& positions) {
  for (const std::uint16_t v : mesh.indices.subspan(part.first_index, part.index_count)) {
    const std::uint16_t target = mesh.merged_into[v];
    if (target != stays) positions[v] = between(mesh.positions[v], parent.positions[target], part.morph);
  }
}

}  // namespace

std::span<const glm::vec3> morphed_positions(const Hlod& hlod, NodeId node, std::span<const DrawRange> ranges,
                                             std::vector<glm::vec3>& scratch) {
  hlod.require(node);
  const NodeMesh mesh = hlod.mesh(node);
  if (std::all_of(ranges.begin(), ranges.end(), [](const DrawRange& range) { return range.morph == 0.0F; }))
    return mesh.positions;
  scratch.assign(mesh.positions.begin(), mesh.positions.end());
  for (const Patch& patch : hlod.patches(node)) {
    if (patch.parent == no_id) continue;  // it has nothing to morph to
    for (const DrawRange& range : ranges) {
      const DrawRange part = shared_part(range, patch);
      if (part.index_count == 0 || part.morph == 0.0F) continue;
      hlod.require(patch.parent);
      morph_patch(mesh, hlod.mesh(patch.parent), part, scratch);
    }
  }
  return scratch;
}

std::span<const glm::vec3> cut_positions(const Hlod& hlod, NodeId node, std::vector<glm::vec3>& scratch) {
  hlod.require(node);
  const std::span<const glm::vec3> mesh = hlod.mesh(node).positions;
  scratch.assign(mesh.begin(), mesh.end());
  if (!hlod.has_within(node)) return scratch;
  hlod.require_within(node);
  const std::span<const glm::vec3> splits = hlod.within(node).positions;
  scratch.insert(scratch.end(), splits.begin(), splits.end());
  return scratch;
}

}  // namespace occlod::hlod
