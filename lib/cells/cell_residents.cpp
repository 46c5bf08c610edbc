#include "cells/cell_residents.h"

#include <algorithm>
#include <utility>

namespace occlod {
namespace {

// For each triangle that is drawn, about: two thirds of a vertex with its normal. What is left out makes borders, so
// there are more than half as many vertices as triangles.
constexpr std::size_t packed_vertex_bytes = 2 * (sizeof(glm::vec3) + sizeof(glm::vec3)) / 3;

}  // namespace

CellResidents::CellResidents(const VlodFile& file, std::size_t base_triangles)
    : tree_(file.tree()),
      triangle_bytes_(sizeof(Triangle) + (file.is_packed() && !file.has_objects() ? packed_vertex_bytes : 0)),
      base_triangles_(base_triangles),
      objects_(file.objects().size()) {}

void CellResidents::add(CellId cell, std::shared_ptr<const CellMesh> mesh) {
  Resident& resident = residents_[cell];
  if (resident.mesh) bytes_ -= resident.mesh->bytes();
  bytes_ += mesh->bytes();
  known_bytes_[cell] = mesh->bytes();
  resident = {std::move(mesh), calls_};
}

const std::shared_ptr<const CellMesh>& CellResidents::find(CellId cell) const {
  static const std::shared_ptr<const CellMesh> none;
  const auto found = residents_.find(cell);
  return found == residents_.end() ? none : found->second.mesh;
}

std::size_t CellResidents::bytes_of(CellId cell) const {
  if (const auto known = known_bytes_.find(cell); known != known_bytes_.end()) return known->second;
  std::size_t triangles = tree_.node(cell).drawn_triangles;
  if (!tree_.is_leaf(cell)) {
    // A split mostly adds two faces to a cut.
    triangles = base_triangles_;
    for (CellId node = cell; node != no_id; node = tree_.node(node).parent)
      triangles += 2 * std::size_t{tree_.node(node).splits};
  }
  const std::size_t blocks = triangles / 256 + objects_;
  return sizeof(CellMesh) + triangles * triangle_bytes_ + blocks * sizeof(TriangleBlock) +
         objects_ * sizeof(CellMesh::Object);
}

void CellResidents::shrink(std::span<const CellId> kept, std::size_t bytes) {
  ++calls_;
  for (const CellId cell : kept)
    if (const auto found = residents_.find(cell); found != residents_.end()) found->second.wanted = calls_;
  while (bytes_ > bytes) {
    auto oldest = residents_.end();
    for (auto at = residents_.begin(); at != residents_.end(); ++at)
      if (at->first != 0 && at->second.wanted < calls_ &&
          (oldest == residents_.end() || at->second.wanted < oldest->second.wanted))
        oldest = at;
    if (oldest == residents_.end()) return;
    bytes_ -= oldest->second.mesh->bytes();
    residents_.erase(oldest);
  }
}

}  // namespace occlod
