#include "splits/wedge_numbers.h"

#include <algorithm>

#include "splits/attribute_state.h"

namespace occlod {
WedgeNumbers::WedgeNumbers(const TriangleMesh& mesh, const CollapseSequence& sequence,
                           std::span<const VertexId> new_ids)
    : mesh_(mesh), new_ids_(new_ids) {
  for (WedgeId w = static_cast<WedgeId>(mesh.vertex_count()); w < mesh.wedge_count(); ++w) add(mesh.vertex_of(w), w);
  for (std::size_t c = 0; c < sequence.attributes.size(); ++c)
    for (const EndedCorners& face : sequence.attributes[c].corners)
      for (int i = 0; i < 3; ++i) add(sequence.collapses[c]->ended(face.slot)[i], face.wedges[i]);
  for (std::size_t f = 0; f < sequence.base_corners.size(); ++f)
    for (int i = 0; i < 3; ++i) add(sequence.base[f].corners[i], sequence.base_corners[f][i]);
  std::sort(extras_.begin(), extras_.end());
  extras_.erase(std::unique(extras_.begin(), extras_.end()), extras_.end());
}

void WedgeNumbers::add(VertexId vertex, WedgeId wedge) {
  if (vertex != wedge) extras_.push_back({new_ids_[vertex], wedge});
}

WedgeId WedgeNumbers::operator()(VertexId vertex, WedgeId wedge) const {
  const VertexId id = new_ids_[vertex];
  if (vertex == wedge) return id;
  const auto at = std::lower_bound(extras_.begin(), extras_.end(), Extra{id, wedge});
  return static_cast<WedgeId>(new_ids_.size()) + static_cast<WedgeId>(at - extras_.begin());
}

Triangle WedgeNumbers::operator()(const Triangle& vertices, const Triangle& wedges) const {
  return {(*this)(vertices.x, wedges.x), (*this)(vertices.y, wedges.y), (*this)(vertices.z, wedges.z)};
}

void WedgeNumbers::copy_attributes(HierarchyData& data) const {
  const std::size_t vertices = new_ids_.size();
  const auto copy = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.resize(vertices + extras_.size());
    for (VertexId v = 0; v < vertices; ++v) to[new_ids_[v]] = from[v];
    for (std::size_t i = 0; i < extras_.size(); ++i) to[vertices + i] = from[extras_[i].wedge];
  };
  copy(mesh_.normals, data.normals);
  copy(mesh_.colors, data.colors);
  copy(mesh_.texture_coordinates, data.texture_coordinates);
  copy(wedge_materials(mesh_), data.wedge_materials);
  data.extra_wedges.reserve(extras_.size());
  for (const Extra& extra : extras_) {
    data.extra_wedges.push_back(extra.vertex);
    data.positions.push_back(glm::vec3(data.positions[extra.vertex]));
  }
}

}  // namespace occlod
