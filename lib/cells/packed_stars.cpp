#include "cells/packed_stars.h"

#include <algorithm>
#include <utility>

#include "splits/star_record.h"

namespace occlod::vlod {

PackedStars::PackedStars(const Hierarchy& hierarchy, std::vector<SplitId> splits)
    : hierarchy_(hierarchy), splits_(std::move(splits)), numbers_(hierarchy.split_count(), no_id) {
  for (SplitId number = 0; number < splits_.size(); ++number) numbers_[splits_[number]] = number;
  number_wedges();
}

void PackedStars::number_wedges() {
  const std::span<const VertexId> extra = hierarchy_.data().extra_wedges;
  wedge_numbers_.assign(extra.size(), no_id);
  const auto use = [&](const Triangle& wedges) {
    for (int k = 0; k < 3; ++k)
      if (wedges[k] >= hierarchy_.vertex_count()) wedge_numbers_[wedges[k] - hierarchy_.vertex_count()] = 0;
  };
  for (const Triangle& wedges : hierarchy_.data().base_corners) use(wedges);
  if (extra.empty()) return;
  for (const SplitId split : splits_) {
    const SplitCorners corners = hierarchy_.corners(split);
    for (std::uint32_t slot = 0; slot < hierarchy_.star(split).inserted_count(); ++slot) use(corners.inserted(slot));
  }
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < extra.size(); ++i) {
    if (i > 0 && extra[i] != extra[i - 1]) last = 0;
    if (wedge_numbers_[i] != no_id) wedge_numbers_[i] = ++last;
  }
}

MeshRow PackedStars::row() const {
  const HierarchyView& data = hierarchy_.data();
  const auto bit_of = [](const auto& values, std::uint32_t bit) { return values.empty() ? 0 : bit; };
  return {static_cast<std::uint32_t>(hierarchy_.base_vertex_count()),
          static_cast<std::uint32_t>(hierarchy_.base_triangle_count()), static_cast<std::uint32_t>(splits_.size()),
          bit_of(data.normals, has_normals) | bit_of(data.colors, has_colors) |
              bit_of(data.texture_coordinates, has_coordinates) | bit_of(data.wedge_materials, has_materials) |
              bit_of(data.extra_wedges, has_seams)};
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
  std::uint32_t extra = 0;
  for_each_wedge(v, [&](WedgeId w) {
    extra += w == v ? 0 : 1;
    if (!data.normals.empty()) frame.normals.push_back(data.normals[w]);
    if (!data.colors.empty()) frame.colors.push_back(data.colors[w]);
    if (!data.texture_coordinates.empty()) frame.coordinates.push_back(data.texture_coordinates[w]);
    if (!data.wedge_materials.empty()) frame.materials.push_back(data.wedge_materials[w]);
  });
  append_corners(split, extra, frame);
}

void PackedStars::append_corners(SplitId split, std::uint32_t extra, GeometryFrame& frame) const {
  const SplitCorners corners = hierarchy_.corners(split);
  if (!corners.are_first())
    for (std::uint32_t slot = 0; slot < hierarchy_.star(split).inserted_count(); ++slot) {
      const Triangle numbers = this->corners(corners.inserted(slot));
      frame.corners.insert(frame.corners.end(), {numbers.x, numbers.y, numbers.z});
    }
  if (frame.extra_wedges.empty()) frame.extra_wedges = frame.corner_starts = {0};
  frame.extra_wedges.push_back(frame.extra_wedges.back() + extra);
  frame.corner_starts.push_back(static_cast<std::uint32_t>(frame.corners.size()));
}

}  // namespace occlod::vlod
