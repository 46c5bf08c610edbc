#include "refine/drawn_mesh.h"

#include <algorithm>
#include <iterator>

#include "splits/active_faces.h"
#include "splits/structure.h"
#include "occlod/hierarchy/cut_mesh.h"

namespace occlod {

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
  // What came and went, or went and came, is no change.
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
      out.push_back({cut.hierarchy().vertex_of(s), cut.hierarchy().star(s).parent_vertex(), t});
  }
}

// Each wedge of the vertex slides from the wedge of its parent in the faces where their charts meet, or in the face
// that took its face's place.
void DrawnMesh::emit_wedge_geomorphs(const Hierarchy& hierarchy, SplitId s, float t, std::vector<Geomorph>& out) {
  const SplitStar star = hierarchy.star(s);
  const SplitCorners corners = hierarchy.corners(s);
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
  // Wedges that other cuts use come along: all of a vertex lie at one place.
  add(star.vertex(), u);
  const WedgeRange extra = extra_wedges_of(hierarchy.data(), star.vertex());
  for (WedgeId w = extra.first; w < extra.first + extra.count; ++w) add(w, u);
}

}  // namespace occlod
