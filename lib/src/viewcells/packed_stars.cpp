#include "viewcells/packed_stars.h"

#include <algorithm>
#include <utility>

#include "hierarchy/star_record.h"

namespace occlod::vlod {

PackedStars::PackedStars(const Hierarchy& hierarchy, std::vector<SplitId> splits)
    : hierarchy_(hierarchy), splits_(std::move(splits)), numbers_(hierarchy.split_count(), no_id) {
  for (SplitId number = 0; number < splits_.size(); ++number) numbers_[splits_[number]] = number;
}

MeshRow PackedStars::row() const {
  return {static_cast<std::uint32_t>(hierarchy_.base_vertex_count()),
          static_cast<std::uint32_t>(hierarchy_.base_triangle_count()), static_cast<std::uint32_t>(splits_.size()),
          (hierarchy_.data().normals.empty() ? 0 : has_normals) | (hierarchy_.data().colors.empty() ? 0 : has_colors)};
}

VertexId PackedStars::vertex(VertexId v) const noexcept {
  const auto base = static_cast<VertexId>(hierarchy_.base_vertex_count());
  return v < base ? v : base + numbers_[v - base];
}

void PackedStars::append(SplitId number, GeometryFrame& frame) const {
  const SplitId split = splits_[number];
  const SplitStar star = hierarchy_.star(split);
  std::vector<Triangle> inserted;
  std::vector<RemovedFace> removed;
  std::vector<SplitId> dependencies;
  star.for_each_inserted([&](const Triangle& t) { inserted.push_back(triangle(t)); });
  star.for_each_removed([&](const FaceRef& face, const Triangle& t) {
    removed.push_back({{number_of(face.split), face.slot}, triangle(t)});
  });
  for (const SplitId needed : star.dependencies()) dependencies.push_back(number_of(needed));
  std::ranges::sort(dependencies);
  const StarShape fan = star.ring().size() == inserted.size() ? StarShape::closed_fan : StarShape::open_fan;
  frame.stars.push_back(static_cast<std::uint32_t>(frame.words.size()));
  append_star({vertex(star.parent_vertex()), star.is_fan() ? fan : StarShape::other, inserted, removed, dependencies},
              frame.words);
  const HierarchyView& data = hierarchy_.data();
  const VertexId v = hierarchy_.vertex_of(split);
  frame.positions.push_back(data.positions[v]);
  if (!data.normals.empty()) frame.normals.push_back(data.normals[v]);
  if (!data.colors.empty()) frame.colors.push_back(data.colors[v]);
}

}  // namespace occlod::vlod
