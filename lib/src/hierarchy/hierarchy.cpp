#include "occlod/hierarchy/hierarchy.h"

#include <cassert>
#include <utility>

namespace occlod {
namespace {

template <typename T>
LargeVector<T> to_vector(std::span<const T> values) {
  return {values.begin(), values.end()};
}

}  // namespace

HierarchyView view_of(const HierarchyData& data) {
  return {data.positions,  data.normals,    data.colors,
          data.nodes,      data.stars,      data.roots,
          data.base_faces, data.box,        data.input_triangle_count,
          data.face_count, data.error_bound};
}

Hierarchy::Hierarchy(HierarchyData data) {
  const auto owned = std::make_shared<const HierarchyData>(std::move(data));
  view_ = view_of(*owned);
  owner_ = owned;
  assert(!view_.nodes.empty() && !view_.positions.empty());
}

Hierarchy::Hierarchy(const HierarchyView& view, std::shared_ptr<const void> owner, std::shared_ptr<SplitGuard> guard)
    : view_(view), owner_(std::move(owner)), guard_(std::move(guard)) {}

HierarchyData Hierarchy::copy_data() const {
  return {to_vector(view_.positions),
          to_vector(view_.normals),
          to_vector(view_.colors),
          to_vector(view_.nodes),
          to_vector(view_.stars),
          to_vector(view_.roots),
          to_vector(view_.base_faces),
          view_.box,
          view_.input_triangle_count,
          view_.face_count,
          view_.error_bound};
}

void Hierarchy::require_all() const {
  for (std::size_t s = 0; s < split_count(); s += SplitGuard::block_size) require(static_cast<SplitId>(s));
}

std::size_t Hierarchy::bytes() const noexcept {
  return view_.positions.size_bytes() + view_.normals.size_bytes() + view_.colors.size_bytes() +
         view_.nodes.size_bytes() + view_.stars.size_bytes() + view_.roots.size_bytes() + view_.base_faces.size_bytes();
}

}  // namespace occlod
