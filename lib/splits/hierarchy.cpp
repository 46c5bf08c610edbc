#include "occlod/hierarchy.h"

#include <cassert>
#include <utility>

#include "splits/hierarchy_data.h"
#include "splits/star.h"

namespace occlod {
namespace {

template <typename T>
UninitializedVector<T> to_vector(std::span<const T> values) {
  return {values.begin(), values.end()};
}

}  // namespace

HierarchyView view_of(const HierarchyData& data) {
  return {data.positions,
          data.normals,
          data.colors,
          data.nodes,
          data.stars,
          data.roots,
          data.base_faces,
          data.box,
          data.input_triangle_count,
          data.face_count,
          data.error_bound,
          data.texture_coordinates,
          data.extra_wedges,
          data.wedge_materials,
          data.corners,
          data.corner_starts,
          data.base_corners,
          data.materials,
          data.textures,
          data.attribute_errors,
          data.texture_origin,
          data.origin,
          data.up};
}

Hierarchy make_hierarchy(HierarchyData data) {
  const auto owned = std::make_shared<const HierarchyData>(std::move(data));
  const HierarchyView view = view_of(*owned);
  assert(!view.nodes.empty() && !view.positions.empty());
  return {view, owned};
}

Hierarchy guarded_hierarchy(const HierarchyView& view, std::shared_ptr<const void> owner,
                            std::shared_ptr<SplitGuard> guard) {
  Hierarchy hierarchy(view, std::move(owner));
  hierarchy.checked_ = guard->checked();
  hierarchy.guard_ = std::move(guard);
  return hierarchy;
}

HierarchyData copy_data(const Hierarchy& hierarchy) {
  const HierarchyView& view = hierarchy.data();
  return {to_vector(view.positions),
          to_vector(view.normals),
          to_vector(view.colors),
          to_vector(view.nodes),
          to_vector(view.stars),
          to_vector(view.roots),
          to_vector(view.base_faces),
          view.box,
          view.input_triangle_count,
          view.face_count,
          view.error_bound,
          to_vector(view.texture_coordinates),
          to_vector(view.extra_wedges),
          to_vector(view.wedge_materials),
          to_vector(view.corners),
          to_vector(view.corner_starts),
          to_vector(view.base_corners),
          {view.materials.begin(), view.materials.end()},
          {view.textures.begin(), view.textures.end()},
          to_vector(view.attribute_errors),
          view.texture_origin,
          view.origin,
          view.up};
}

Hierarchy::Hierarchy(const HierarchyView& view, std::shared_ptr<const void> owner)
    : view_(view), owner_(std::move(owner)) {}

void Hierarchy::check_block(std::size_t block) const {
  static_assert(block_bits == SplitGuard::block_bits);
  guard_->check(block);
}

void Hierarchy::require_all() const {
  for (std::size_t s = 0; s < split_count(); s += SplitGuard::block_size) require(static_cast<SplitId>(s));
}

std::size_t Hierarchy::bytes() const noexcept {
  return view_.positions.size_bytes() + view_.normals.size_bytes() + view_.colors.size_bytes() +
         view_.nodes.size_bytes() + view_.stars.size_bytes() + view_.roots.size_bytes() +
         view_.base_faces.size_bytes() + view_.texture_coordinates.size_bytes() + view_.extra_wedges.size_bytes() +
         view_.wedge_materials.size_bytes() + view_.corners.size_bytes() + view_.corner_starts.size_bytes() +
         view_.base_corners.size_bytes() + view_.attribute_errors.size_bytes();
}

SplitFaces Hierarchy::faces_of(SplitId s) const {
  const SplitStar star = star_of(*this, s);
  const SplitCorners corners = corners_of_star(*this, s);
  SplitFaces faces{star.vertex(), star.parent_vertex(), {}, {}, {}, {}, {}};
  faces.dependencies.assign(star.dependencies().begin(), star.dependencies().end());
  for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot) {
    faces.inserted.push_back(star.inserted(slot));
    faces.inserted_wedges.push_back(corners.inserted(slot));
  }
  star.for_each_removed([&](const FaceRef& ref, const Triangle& vertices) {
    faces.removed_refs.push_back(ref);
    faces.removed.push_back(vertices);
  });
  return faces;
}

VertexId Hierarchy::parent_vertex(SplitId s) const noexcept { return star_of(*this, s).parent_vertex(); }

}  // namespace occlod
