#include "viewcells/cell_mesh.h"

#include <algorithm>
#include <glm/common.hpp>

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

// Halves at the median of the longest axis until blocks are small.
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

CellMesh CellMeshMaker::make(CellId cell, std::span<const CellAdditions* const> path) {
  const CellTree& tree = file_.tree();
  const bool is_leaf = tree.is_leaf(cell);
  CellMesh mesh;
  mesh.objects.resize(objects_.size());
  if (is_leaf) mesh.error_px = tree.node(cell).error_px;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const CellView view(tree.node(cell).box, file_.options().cell.eyes, objects_[i].object_to_world);
    gather(i, path, is_leaf);
    faces_.set(i, applied_);
    faces_.drawn(i, view, hidden_, drawn_);
    if (!is_leaf) mesh.error_px = std::max(mesh.error_px, error_px(i, view));
    append(i, mesh);
  }
  mesh.triangles.shrink_to_fit();
  mesh.blocks.shrink_to_fit();
  return mesh;
}

void CellMeshMaker::gather(std::uint32_t object, std::span<const CellAdditions* const> path, bool with_hidden) {
  applied_.clear();
  hidden_.clear();
  for (const CellAdditions* node : path) {
    const auto found = std::ranges::lower_bound(node->objects, object, {}, &ObjectAdditions::object);
    if (found == node->objects.end() || found->object != object) continue;
    applied_.insert(applied_.end(), found->splits.begin(), found->splits.end());
    if (with_hidden) hidden_.insert(hidden_.end(), found->hidden.begin(), found->hidden.end());
  }
  std::ranges::sort(applied_);
  std::ranges::sort(hidden_, {}, face_key);
}

// Errors of subtrees are in their topmost splits, so those next to the cut tell the most.
double CellMeshMaker::error_px(std::uint32_t object, const CellView& view) const {
  const Hierarchy& hierarchy = *objects_[object].hierarchy;
  double error = 0.0;
  const auto look_at = [&](SplitId s) {
    if (s == no_id || std::ranges::binary_search(applied_, s)) return;
    const SplitNode& node = hierarchy.node(s);
    error = std::max(
        error, static_cast<double>(node.guaranteed_error) * static_cast<double>(view.largest_scale_px(node.sphere)));
  };
  for (const SplitId root : hierarchy.data().roots) look_at(root);
  for (const SplitId s : applied_) {
    look_at(hierarchy.node(s).child_u);
    look_at(hierarchy.node(s).child_v);
  }
  return error;
}

void CellMeshMaker::append(std::uint32_t object, CellMesh& mesh) {
  CellMesh::Object& place = mesh.objects[object];
  place = {static_cast<std::uint32_t>(mesh.triangles.size()), static_cast<std::uint32_t>(drawn_.size()),
           static_cast<std::uint32_t>(mesh.blocks.size()), 0};
  if (drawn_.empty()) return;
  divide(drawn_, 0, objects_[object].hierarchy->positions(), mesh.blocks);
  place.blocks = static_cast<std::uint32_t>(mesh.blocks.size()) - place.first_block;
  mesh.triangles.insert(mesh.triangles.end(), drawn_.begin(), drawn_.end());
}

}  // namespace occlod
