#include "refine/drawn_mesh.h"

#include <algorithm>
#include <iterator>

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
  for (const auto& [s, born] : morphs_)
    out.push_back({cut.hierarchy().vertex_of(s), cut.hierarchy().star(s).parent_vertex(),
                   static_cast<float>(frame_ - born + 1) / static_cast<float>(geomorph_frames + 1)});
}

}  // namespace occlod
