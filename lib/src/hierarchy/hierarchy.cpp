#include "occlod/hierarchy/hierarchy.h"

#include <algorithm>
#include <cassert>

namespace occlod {
namespace {

template <typename T>
std::size_t bytes_of(const std::vector<T>& v) {
  return v.size() * sizeof(T);
}

}  // namespace

Hierarchy::Hierarchy(HierarchyData data) : data_(std::move(data)) {
  assert(!data_.nodes.empty() && !data_.positions.empty());
  box_ = bounding_box(data_.positions);
  input_triangle_count_ = static_cast<std::size_t>(std::count(data_.died.begin(), data_.died.end(), no_id));
  for (std::size_t s = 0; s < split_count(); ++s)
    error_bound_ = std::max(error_bound_, data_.nodes[s].guaranteed_error);
}

std::size_t Hierarchy::bytes() const noexcept {
  const HierarchyData& d = data_;
  return bytes_of(d.positions) + bytes_of(d.normals) + bytes_of(d.colors) + bytes_of(d.nodes) + bytes_of(d.roots) +
         bytes_of(d.first_dependency) + bytes_of(d.dependencies) + bytes_of(d.faces) + bytes_of(d.died) +
         bytes_of(d.removed_faces) + bytes_of(d.boxes) + bytes_of(d.cylinders);
}

}  // namespace occlod
