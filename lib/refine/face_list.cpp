#include "refine/face_list.h"

#include <algorithm>
#include <cassert>
#include <functional>

#include "occlod/hierarchy/cut_mesh.h"

namespace occlod {

FaceList::FaceList(const Hierarchy& hierarchy, std::vector<Triangle>& triangles)
    : hierarchy_(&hierarchy), triangles_(&triangles), blocks_(zeroed_array<std::uint32_t>(hierarchy.split_count())) {}

void FaceList::assign(const Cut& cut) {
  for (const SplitId s : owners_)
    if (s != no_id) blocks_[s] = 0;
  owners_.clear();
  places_.clear();
  free_blocks_.clear();
  triangles_->clear();
  faces_.clear();
  frames_.clear();
  base_places_.assign(hierarchy_->base_triangle_count(), nowhere);
  begin_frame();
  cut.for_each_active([&](const FaceRef& face, const Triangle& triangle) {
    if (face.split != no_id && blocks_[face.split] == 0) new_block_of(face.split);
    add(face, drawn(face, triangle));
  });
  for (const SplitId s : cut.applied_splits())  // of which no face is active
    if (cut.applied(s) && blocks_[s] == 0) new_block_of(s);
}

void FaceList::begin_frame() noexcept {
  ++frame_;
  touched_.clear();
}

void FaceList::apply(SplitId s) {
  const SplitStar star = hierarchy_->star(s);
  assert(holes_.empty());
  star.for_each_removed([&](const FaceRef& face, const Triangle&) {
    std::uint32_t& place = place_of(face);
    assert(place != nowhere);
    holes_.push_back(place);
    place = nowhere;
  });
  new_block_of(s);
  for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot)
    add({s, slot}, drawn({s, slot}, star.inserted(slot)));
  fill_holes();
}

void FaceList::take_back(SplitId s) {
  const SplitStar star = hierarchy_->star(s);
  assert(holes_.empty());
  for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot) holes_.push_back(place_of({s, slot}));
  free_block_of(s);
  // With the corners in the order in which they were: the removed list may start at another.
  star.for_each_removed([&](const FaceRef& face, const Triangle&) {
    add(face, drawn(face, face.split == no_id ? hierarchy_->data().base_faces[face.slot]
                                              : hierarchy_->star(face.split).inserted(face.slot)));
  });
  fill_holes();
}

Triangle FaceList::drawn(const FaceRef& face, const Triangle& vertices) const {
  return wedges_of_face(*hierarchy_, face, vertices);
}

std::uint32_t& FaceList::place_of(const FaceRef& face) {
  return face.split == no_id ? base_places_[face.slot] : places_[blocks_[face.split] - 1 + face.slot];
}

void FaceList::put(std::uint32_t place, const FaceRef& face, const Triangle& triangle) {
  (*triangles_)[place] = triangle;
  faces_[place] = face;
  place_of(face) = place;
  touch(place);
}

void FaceList::add(const FaceRef& face, const Triangle& triangle) {
  if (holes_.empty()) {
    holes_.push_back(static_cast<std::uint32_t>(triangles_->size()));
    triangles_->emplace_back();
    faces_.emplace_back();
    frames_.push_back(0);
  }
  const std::uint32_t place = holes_.back();
  holes_.pop_back();
  put(place, face, triangle);
}

// With the last triangles.
void FaceList::fill_holes() {
  std::sort(holes_.begin(), holes_.end(), std::greater<>());
  for (const std::uint32_t hole : holes_) {
    const auto last = static_cast<std::uint32_t>(triangles_->size() - 1);
    if (hole != last) put(hole, faces_[last], (*triangles_)[last]);
    triangles_->pop_back();
    faces_.pop_back();
    frames_.pop_back();
  }
  holes_.clear();
}

void FaceList::touch(std::uint32_t place) {
  if (frames_[place] == frame_) return;
  frames_[place] = frame_;
  touched_.push_back(place);
}

void FaceList::new_block_of(SplitId s) {
  const std::uint32_t size = hierarchy_->star(s).inserted_count();
  if (free_blocks_.size() <= size) free_blocks_.resize(size + 1);
  std::vector<std::uint32_t>& free = free_blocks_[size];
  if (free.empty()) {
    free.push_back(static_cast<std::uint32_t>(places_.size()));
    places_.resize(places_.size() + size, nowhere);
    owners_.resize(places_.size(), no_id);
  }
  const std::uint32_t first = free.back();
  free.pop_back();
  std::fill_n(places_.begin() + first, size, nowhere);
  blocks_[s] = first + 1;
  owners_[first] = s;
}

void FaceList::free_block_of(SplitId s) {
  const std::uint32_t first = blocks_[s] - 1;
  free_blocks_[hierarchy_->star(s).inserted_count()].push_back(first);
  owners_[first] = no_id;
  blocks_[s] = 0;
}

void FaceList::changes(std::vector<TriangleRange>& out) {
  out.clear();
  std::sort(touched_.begin(), touched_.end());
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  for (const std::uint32_t place : touched_) {
    if (place >= triangles_->size()) break;
    if (!out.empty() && out.back().first + out.back().count == place)
      ++out.back().count;
    else
      out.push_back({place, 1});
  }
}

}  // namespace occlod
