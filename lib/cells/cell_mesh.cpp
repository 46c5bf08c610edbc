#include "cells/cell_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>

#include "refine/screen_error.h"

namespace occlod {
namespace {

constexpr std::size_t block_triangles = 512;  // at most

Box box_around(std::span<const Triangle> triangles, std::span<const glm::vec3> positions) {
  Box box{positions[triangles[0].x], positions[triangles[0].x]};
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      box.min = glm::min(box.min, positions[t[k]]);
      box.max = glm::max(box.max, positions[t[k]]);
    }
  return box;
}

// Halves ranges at the median of the longest axis until blocks are small.
void divide(std::span<Triangle> triangles, std::uint32_t first, std::span<const glm::vec3> positions,
            std::vector<TriangleBlock>& blocks) {
  const Box box = box_around(triangles, positions);
  if (triangles.size() <= block_triangles) {
    blocks.push_back({box, first, static_cast<std::uint32_t>(triangles.size())});
    return;
  }
  const glm::vec3 size = box.max - box.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto key = [&](const Triangle& t) {
    return positions[t.x][axis] + positions[t.y][axis] + positions[t.z][axis];
  };
  const std::size_t half = triangles.size() / 2;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half), triangles.end(),
                   [&](const Triangle& a, const Triangle& b) { return key(a) < key(b); });
  divide(triangles.first(half), first, positions, blocks);
  divide(triangles.subspan(half), first + static_cast<std::uint32_t>(half), positions, blocks);
}

}  // namespace

CellMeshMaker::CellMeshMaker(const VlodFile& file, std::span<const RefineObject> objects)
    : file_(file), objects_(objects.begin(), objects.end()), faces_(objects) {}

CellMeshMaker::CellMeshMaker(const VlodFile& file, vlod::GeometryCache& cache, std::size_t max_bytes)
    : file_(file),
      objects_(placements(file)),
      faces_(std::span<const RefineObject>()),
      packed_(std::in_place, cache, max_bytes) {}

CellMesh CellMeshMaker::make(CellId cell, std::span<const CellAdditions* const> path) {
  const bool is_leaf = file_.tree().is_leaf(cell), has_error = is_leaf || packed_;
  CellMesh mesh;
  mesh.objects.resize(objects_.size());
  if (has_error) mesh.error_px = file_.tree().node(cell).error_px;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const CellView view = view_of(cell, i);
    cut_.gather(i, path, is_leaf);
    draw(cell, i, view);
    if (!has_error) mesh.error_px = std::max(mesh.error_px, error_of(i, view));
    append(i, mesh);
  }
  mesh.triangles.shrink_to_fit();
  mesh.blocks.shrink_to_fit();
  mesh.positions.shrink_to_fit();
  mesh.normals.shrink_to_fit();
  mesh.colors.shrink_to_fit();
  mesh.coordinates.shrink_to_fit();
  mesh.materials.shrink_to_fit();
  return mesh;
}

double CellMeshMaker::error_px(CellId cell, std::span<const CellAdditions* const> path) {
  double error = 0.0;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    cut_.gather(i, path, false);
    error = std::max(error, error_of(i, view_of(cell, i)));
  }
  return error;
}

CellView CellMeshMaker::view_of(CellId cell, std::uint32_t object) const {
  return {file_.tree().node(cell).box, file_.options().cell.eyes, objects_[object].object_to_world};
}

void CellMeshMaker::draw(CellId cell, std::uint32_t object, const CellView& view) {
  if (packed_) {
    packed_->draw(object, cut_.applied, cut_.hidden, objects_[object].two_sided ? nullptr : &view,
                  fmt::format("cell {}", cell), drawn_);
    return;
  }
  faces_.set(object, cut_.applied);
  faces_.drawn(object, view, cut_.hidden, drawn_.triangles);
}

// The topmost splits of subtrees have their largest errors, so the splits next to the cut determine the error.
double CellMeshMaker::error_of(std::uint32_t object, const CellView& view) const {
  const Hierarchy& hierarchy = *objects_[object].hierarchy;
  double error = 0.0;
  const auto look_at = [&](SplitId s) {
    if (s == no_id || std::ranges::binary_search(cut_.applied, s)) return;
    const float own = errors_of(hierarchy, s, objects_[object].attributes).guaranteed;
    error = std::max(error,
                     static_cast<double>(own) * static_cast<double>(view.largest_scale_px(hierarchy.node(s).sphere)));
  };
  for (const SplitId root : hierarchy.data().roots) look_at(root);
  for (const SplitId s : cut_.applied) {
    look_at(hierarchy.node(s).child_u);
    look_at(hierarchy.node(s).child_v);
  }
  return error;
}

void CellMeshMaker::append(std::uint32_t object, CellMesh& mesh) {
  const auto size = [](const auto& values) { return static_cast<std::uint32_t>(values.size()); };
  const auto add = [&](const auto& from, auto& to) {
    const CellMesh::Object::Part part{size(to), size(from)};
    to.insert(to.end(), from.begin(), from.end());
    return part;
  };
  CellMesh::Object& place = mesh.objects[object];
  place.first_triangle = size(mesh.triangles);
  place.triangles = size(drawn_.triangles);
  place.first_block = size(mesh.blocks);
  if (drawn_.triangles.empty()) return;
  const std::span<const glm::vec3> positions =
      packed_ ? std::span<const glm::vec3>(drawn_.positions) : objects_[object].hierarchy->positions();
  divide(drawn_.triangles, 0, positions, mesh.blocks);
  place.blocks = size(mesh.blocks) - place.first_block;
  add(drawn_.triangles, mesh.triangles);
  place.positions = add(drawn_.positions, mesh.positions);
  place.normals = add(drawn_.normals, mesh.normals);
  place.colors = add(drawn_.colors, mesh.colors);
  place.coordinates = add(drawn_.texture_coordinates, mesh.coordinates);
  place.materials = add(drawn_.materials, mesh.materials);
}

}  // namespace occlod
