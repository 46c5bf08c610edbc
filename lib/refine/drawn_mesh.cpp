#include "refine/drawn_mesh.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <iterator>

#include "occlod/build_hierarchy.h"
#include "occlod/refiner.h"
#include "splits/active_faces.h"
#include "splits/star.h"
#include "splits/structure.h"

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
  for (const SplitId s : cut.applied_splits())  // also if none of its faces is active
    if (cut.applied(s) && blocks_[s] == 0) new_block_of(s);
}

void FaceList::begin_frame() noexcept {
  ++frame_;
  touched_.clear();
}

void FaceList::apply(SplitId s) {
  const SplitStar star = star_of(*hierarchy_, s);
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
  const SplitStar star = star_of(*hierarchy_, s);
  assert(holes_.empty());
  for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot) holes_.push_back(place_of({s, slot}));
  free_block_of(s);
  // Keeps the corners in their original order: the removed list may start at another corner.
  star.for_each_removed([&](const FaceRef& face, const Triangle&) {
    add(face, drawn(face, face.split == no_id ? hierarchy_->data().base_faces[face.slot]
                                              : star_of(*hierarchy_, face.split).inserted(face.slot)));
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

// Moves the last triangles into the holes.
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
  const std::uint32_t size = star_of(*hierarchy_, s).inserted_count();
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
  free_blocks_[star_of(*hierarchy_, s).inserted_count()].push_back(first);
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

void DrawnMesh::begin_frame() {
  ++frame_;
  assigned_ = false;
  faces_.begin_frame();
  born_.clear();
  died_.clear();
}

void DrawnMesh::assign(const Cut& cut) {
  assigned_ = true;
  morphs_.clear();
  faces_.assign(cut);
}

void DrawnMesh::apply(SplitId s) {
  faces_.apply(s);
  born_.push_back(s);
}

void DrawnMesh::take_back(SplitId s) {
  faces_.take_back(s);
  died_.push_back(s);
}

void DrawnMesh::emit(const Cut& cut, std::uint32_t geomorph_frames, RefinedObject& out, RefineStats& stats) {
  faces_.changes(out.changes);
  for (const TriangleRange& range : out.changes) stats.changed_triangles += range.count;
  if (assigned_)
    emit_all_splits(cut, out.splits, stats);
  else
    emit_splits(cut, out.splits, stats);
  emit_geomorphs(cut, geomorph_frames, out.geomorphs);
}

void DrawnMesh::emit_all_splits(const Cut& cut, std::vector<SplitId>& out, RefineStats& stats) const {
  stats.merged_splits += out.size();
  out.clear();
  for (const SplitId s : cut.applied_splits())
    if (cut.applied(s)) out.push_back(s);
  std::sort(out.begin(), out.end());
  stats.new_splits += out.size();
}

void DrawnMesh::emit_splits(const Cut& cut, std::vector<SplitId>& out, RefineStats& stats) {
  // A split that was applied and taken back in one frame, or the reverse, is no change.
  const auto keep_changes = [&](std::vector<SplitId>& splits, bool applied) {
    std::sort(splits.begin(), splits.end());
    splits.erase(std::unique(splits.begin(), splits.end()), splits.end());
    std::erase_if(splits, [&](SplitId s) {
      return cut.applied(s) != applied || std::binary_search(out.begin(), out.end(), s) == applied;
    });
  };
  keep_changes(born_, true);
  keep_changes(died_, false);
  stats.new_splits += born_.size();
  stats.merged_splits += died_.size();
  if (born_.empty() && died_.empty()) return;
  kept_.clear();
  std::set_difference(out.begin(), out.end(), died_.begin(), died_.end(), std::back_inserter(kept_));
  out.clear();
  std::merge(kept_.begin(), kept_.end(), born_.begin(), born_.end(), std::back_inserter(out));
}

void DrawnMesh::emit_geomorphs(const Cut& cut, std::uint32_t geomorph_frames, std::vector<Geomorph>& out) {
  out.clear();
  if (geomorph_frames > 0)
    for (const SplitId s : born_) morphs_.emplace_back(s, frame_);
  std::erase_if(morphs_, [&](const auto& morph) {
    return !cut.applied(morph.first) || frame_ - morph.second >= geomorph_frames;
  });
  for (const auto& [s, born] : morphs_) {
    const float t = static_cast<float>(frame_ - born + 1) / static_cast<float>(geomorph_frames + 1);
    if (cut.hierarchy().has_seams())
      emit_wedge_geomorphs(cut.hierarchy(), s, t, out);
    else
      out.push_back({cut.hierarchy().vertex_of(s), star_of(cut.hierarchy(), s).parent_vertex(), t});
  }
}

// Lets each wedge of the vertex slide from a wedge of its parent: the one in a face that has both, or the one in the
// removed face whose place the wedge's face takes.
void DrawnMesh::emit_wedge_geomorphs(const Hierarchy& hierarchy, SplitId s, float t, std::vector<Geomorph>& out) {
  const SplitStar star = star_of(hierarchy, s);
  const SplitCorners corners = corners_of_star(hierarchy, s);
  const VertexId u = star.parent_vertex();
  const std::size_t first = out.size();
  const auto add = [&](WedgeId wedge, WedgeId of_u) {
    const auto known = std::find_if(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
                                    [&](const Geomorph& g) { return g.vertex == wedge; });
    if (known == out.end()) out.push_back({wedge, of_u, t});
  };
  const auto corner_of = [&](const Triangle& face, const Triangle& wedges, VertexId v) {
    return face.x == v ? wedges.x : face.y == v ? wedges.y : face.z == v ? wedges.z : WedgeId{no_id};
  };
  for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot) {
    const Triangle face = star.inserted(slot), wedges = corners.inserted(slot);
    const WedgeId of_v = corner_of(face, wedges, star.vertex()), of_u = corner_of(face, wedges, u);
    if (of_v != no_id && of_u != no_id) add(of_v, of_u);
  }
  star.for_each_removed([&](const FaceRef& ref, const Triangle& removed) {
    const Triangle vertices = face_at(hierarchy, ref);
    const WedgeId of_u = corner_of(vertices, wedges_of_face(hierarchy, ref, vertices), u);
    for (std::uint32_t slot = 0; of_u != no_id && slot < star.inserted_count(); ++slot) {
      const Triangle face = star.inserted(slot);
      int shared = 0;
      for (int k = 0; k < 3; ++k)
        shared += face[k] == removed.x || face[k] == removed.y || face[k] == removed.z ? 1 : 0;
      const WedgeId of_v = corner_of(face, corners.inserted(slot), star.vertex());
      if (shared == 2 && of_v != no_id && corner_of(face, face, u) == no_id) add(of_v, of_u);
    }
  });
  // Wedges that only other cuts use slide too, because all wedges of a vertex lie at one place.
  add(star.vertex(), u);
  const WedgeRange extra = extra_wedges_of(hierarchy.data(), star.vertex());
  for (WedgeId w = extra.first; w < extra.first + extra.count; ++w) add(w, u);
}

void group_by_material(const Hierarchy& hierarchy, std::span<const Triangle> triangles, MaterialRanges& out) {
  std::vector<std::uint32_t> places(std::max<std::size_t>(hierarchy.data().materials.size(), 1), 0);
  for (const Triangle& t : triangles) ++places[hierarchy.material_of(t.x)];
  out.ranges.clear();
  std::uint32_t next = 0;
  for (std::size_t m = 0; m < places.size(); ++m) {
    const std::uint32_t count = places[m];
    if (count > 0) out.ranges.push_back({static_cast<MaterialId>(m), next, count});
    places[m] = next;
    next += count;
  }
  out.triangles.resize(triangles.size());
  for (const Triangle& t : triangles) out.triangles[places[hierarchy.material_of(t.x)]++] = t;
}

}  // namespace occlod
