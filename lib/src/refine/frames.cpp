#include "refine/frames.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "occlod/core/error.h"

namespace occlod {

Frames::Frames(std::span<const RefineObject> objects, std::span<RefinedObject> result) {
  for (std::size_t i = 0; i < objects.size(); ++i) objects_.emplace_back(*objects[i].hierarchy, result[i].triangles);
}

void Frames::begin(const RefinedCuts& refined, const RefineOptions& options) {
  refined_ = refined;
  options_ = &options;
  ++frame_;
  adopted_ = false;
  changes_ = 0;
  triangles_ = 0;
  for (const Cut& cut : refined_.cuts) triangles_ += cut.triangle_count();
  for (Object& object : objects_) {
    object.faces.begin_frame();
    object.born.clear();
    object.died.clear();
  }
  left_ = {};
}

void Frames::adopt(const RefinedCuts& refined, const RefineOptions& options, float level,
                   std::span<const Entry> hidden) {
  begin(refined, options);
  adopted_ = true;
  adopted_draw_ = draw_;
  at_rest_ = false;
  level_ = level;
  last_view_ = *refined.view;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) adopt_splits(i);
  for (const Entry& entry : hidden) {
    Front& front = objects_[entry.object].front;
    front.set(front.obtain(entry.split), entry.kind == Entry::Kind::visit ? Front::subtree_hidden : Front::star_hidden,
              true);
  }
  for (std::uint32_t i = 0; i < objects_.size(); ++i) adopt_forest(i);
  before_ = count_applied();
}

void Frames::adopt_splits(std::uint32_t object) {
  Object& to = objects_[object];
  const Cut& cut = refined_.cuts[object];
  to.front.clear();
  to.morphs.clear();
  to.faces.assign(cut);
  to.motion = {};
  to.view = refined_.views[object];
  for (const SplitId s : cut.applied_splits()) {
    if (!cut.applied(s)) continue;
    const Front::Index k = to.front.obtain(s);
    to.front.set(k, Front::applied, true);
    to.front.set(k, Front::leaf, cut.is_leaf(s));
  }
}

void Frames::adopt_forest(std::uint32_t object) {
  Front& front = objects_[object].front;
  open_.clear();
  reached_.clear();
  for (const SplitId root : refined_.cuts[object].hierarchy().data().roots) {
    open_.push_back(root);
    reached_.push_back(reach(object, root, no_id, 0));
  }
  while (!open_.empty()) {  // level by level
    renew(object, reached_);
    reached_.clear();
    sorted_.swap(open_);
    open_.clear();
    for (const SplitId s : sorted_) {
      const Front::Index k = front.find(s);
      if (front.is(k, Front::subtree_hidden) || !(front.error_at_most(k).quadric_px > level_)) continue;
      descend_from(object, s, [&](SplitId child) {
        open_.push_back(child);
        reached_.push_back(front.find(child));
      });
    }
  }
  for (std::size_t k = front.size(); k-- > 0;) {
    const auto at = static_cast<Front::Index>(k);
    if (!front.is(at, Front::reached) && !front.is(at, Front::applied)) front.remove(at);
  }
  renew_outdated(object);  // what is applied without being reached
}

// What it is worth is not known yet.
Front::Index Frames::reach(std::uint32_t object, SplitId s, SplitId parent, std::uint16_t level) {
  const Hierarchy& hierarchy = refined_.cuts[object].hierarchy();
  hierarchy.require(s);
  if (hierarchy.node(s).parent != parent)
    throw Error({"hierarchy", "split " + std::to_string(s), "is not where its parent says", "build it again"});
  Front& front = objects_[object].front;
  const Front::Index k = front.obtain(s);
  front.set(k, Front::reached, true);
  front.node(k).level = level;
  return k;
}

Frames::Applied Frames::count_applied() const {
  Applied applied;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const BoundedProducts of = errors(i);
    const std::size_t all = count(of, {.all = Front::applied});
    applied.all += all;
    applied.worthless +=
        all - count(of, {.all = Front::applied, .none = Front::subtree_hidden, .may_exceed = closing * level_});
  }
  return applied;
}

// Gives up nodes that matter too little to be descended.
void Frames::close(std::uint32_t object) {
  Front& front = objects_[object].front;
  found_.clear();
  const BoundedProducts of = errors(object);
  select(of, {.all = Front::descended | Front::subtree_hidden}, found_);
  select(of, {.all = Front::descended, .none = Front::subtree_hidden, .may_be_below = closing * level_}, found_);
  open_.clear();
  for (const Front::Index k : found_) open_.push_back(front.node(k).split);
  for (const SplitId first : open_)
    for (SplitId s = first; s != no_id && close_one(object, s);) s = refined_.cuts[object].hierarchy().node(s).parent;
}

bool Frames::is_closable(std::uint32_t object, Front::Index k) const {
  const Front& front = objects_[object].front;
  return front.is(k, Front::subtree_hidden) ||
         front.scales().error_factor[k] * front.error_at_most(k).quadric_px <= closing * level_;
}

bool Frames::close_one(std::uint32_t object, SplitId s) {
  Front& front = objects_[object].front;
  const Front::Index k = front.find(s);
  if (k == Front::none || !front.is(k, Front::descended) || !is_closable(object, k)) return false;
  const SplitNode& split = refined_.cuts[object].hierarchy().node(s);
  for (const SplitId child : {split.child_u, split.child_v})
    if (child != no_id && front.is(front.find(child), Front::descended)) return false;
  front.set(k, Front::descended, false);
  for (const SplitId child : {split.child_u, split.child_v}) {
    if (child == no_id) continue;
    const Front::Index below = front.find(child);
    front.set(below, Front::reached, false);
    if (!front.is(below, Front::applied)) front.remove(below);
  }
  return true;
}

void Frames::emit(std::uint32_t i, RefinedObject& out, RefineStats& stats) {
  Object& object = objects_[i];
  object.faces.changes(out.changes);
  for (const TriangleRange& range : out.changes) stats.changed_triangles += range.count;
  emit_splits(object, refined_.cuts[i], out, stats);
  emit_geomorphs(object, refined_.cuts[i], out.geomorphs);
  at_rest_ = at_rest_ && out.geomorphs.empty();
}

void Frames::emit_splits(Object& object, const Cut& cut, RefinedObject& out, RefineStats& stats) {
  if (adopted_) {
    stats.merged_splits += out.splits.size();
    out.splits.clear();
    for (Front::Index k = 0; k < object.front.size(); ++k)
      if (object.front.is(k, Front::applied)) out.splits.push_back(object.front.node(k).split);
    std::sort(out.splits.begin(), out.splits.end());
    stats.new_splits += out.splits.size();
    return;
  }
  // What came and went, or went and came, is no change.
  const auto settle = [&](std::vector<SplitId>& splits, bool applied) {
    std::sort(splits.begin(), splits.end());
    splits.erase(std::unique(splits.begin(), splits.end()), splits.end());
    std::erase_if(splits, [&](SplitId s) {
      return cut.applied(s) != applied || std::binary_search(out.splits.begin(), out.splits.end(), s) == applied;
    });
  };
  for (const SplitId s : object.born)
    if (const Front::Index k = object.front.find(s); k != Front::none) object.front.set(k, Front::is_new, false);
  settle(object.born, true);
  settle(object.died, false);
  stats.new_splits += object.born.size();
  stats.merged_splits += object.died.size();
  if (object.born.empty() && object.died.empty()) return;
  sorted_.clear();
  std::set_difference(out.splits.begin(), out.splits.end(), object.died.begin(), object.died.end(),
                      std::back_inserter(sorted_));
  out.splits.clear();
  std::merge(sorted_.begin(), sorted_.end(), object.born.begin(), object.born.end(), std::back_inserter(out.splits));
}

void Frames::emit_geomorphs(Object& object, const Cut& cut, std::vector<Geomorph>& out) const {
  out.clear();
  const std::uint32_t frames = options_->update.geomorph_frames;
  if (frames > 0 && !adopted_)
    for (const SplitId s : object.born) object.morphs.emplace_back(s, frame_);
  std::erase_if(object.morphs,
                [&](const auto& morph) { return !cut.applied(morph.first) || frame_ - morph.second >= frames; });
  for (const auto& [s, born] : object.morphs)
    out.push_back({cut.hierarchy().vertex_of(s), cut.hierarchy().star(s).parent_vertex(),
                   static_cast<float>(frame_ - born + 1) / static_cast<float>(frames + 1)});
}

}  // namespace occlod
