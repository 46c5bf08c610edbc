#include "refine/front_forest.h"

#include "refine/forest.h"

namespace occlod {

void FrontForest::adopt_splits(std::uint32_t object) {
  Front& front = evaluation_.front(object);
  const Cut& cut = (*evaluation_.scene().cuts)[object];
  for (const SplitId s : cut.applied_splits()) {
    if (!cut.applied(s)) continue;
    const Front::Index k = front.obtain(s);
    front.set(k, Front::applied, true);
    front.set(k, Front::leaf, cut.is_leaf(s));
  }
}

void FrontForest::adopt_forest(std::uint32_t object, float level) {
  Front& front = evaluation_.front(object);
  const std::span<const SplitId> roots = evaluation_.scene().hierarchy(object).data().roots;
  reached_.clear();
  for (const SplitId root : roots) reach(object, root, no_id, 0);
  open_.assign(roots.begin(), roots.end());
  while (!open_.empty()) {  // level by level
    evaluation_.evaluate(object, reached_);
    reached_.clear();
    level_.swap(open_);
    open_.clear();
    for (const SplitId s : level_) {
      const Front::Index k = front.find(s);
      if (front.is(k, Front::subtree_hidden) || !(front.error_at_most(k).quadric_px > level)) continue;
      const std::size_t before = reached_.size();
      reach_children(object, s);
      for (std::size_t i = before; i < reached_.size(); ++i) open_.push_back(front.node(reached_[i]).split);
    }
  }
  for (std::size_t k = front.size(); k-- > 0;) {
    const auto at = static_cast<Front::Index>(k);
    if (!front.is(at, Front::reached) && !front.is(at, Front::applied)) front.remove(at);
  }
  evaluation_.evaluate_expired(object);  // what is applied without being reached
}

std::span<const Front::Index> FrontForest::descend(std::uint32_t object, SplitId s) {
  reached_.clear();
  reach_children(object, s);
  evaluation_.evaluate(object, reached_);
  return reached_;
}

// What it is worth is not known yet.
void FrontForest::reach(std::uint32_t object, SplitId s, SplitId parent, std::uint16_t level) {
  const Hierarchy& hierarchy = evaluation_.scene().hierarchy(object);
  hierarchy.require(s);
  require_parent(hierarchy, s, parent);
  Front& front = evaluation_.front(object);
  const Front::Index k = front.obtain(s);
  front.set(k, Front::reached, true);
  front.node(k).level = level;
  reached_.push_back(k);
}

void FrontForest::reach_children(std::uint32_t object, SplitId s) {
  Front& front = evaluation_.front(object);
  const Front::Index k = front.find(s);
  front.set(k, Front::descended, true);
  const SplitNode& split = evaluation_.scene().hierarchy(object).node(s);
  for (const SplitId child : {split.child_u, split.child_v})
    if (child != no_id) reach(object, child, s, FrontNode::below(front.node(k).level));
}

void FrontForest::close(std::uint32_t object, float least) {
  Front& front = evaluation_.front(object);
  const Hierarchy& hierarchy = evaluation_.scene().hierarchy(object);
  found_.clear();
  const BoundedProducts of = evaluation_.errors(object);
  select(of, {.all = Front::descended | Front::subtree_hidden}, found_);
  select(of, {.all = Front::descended, .none = Front::subtree_hidden, .may_be_below = least}, found_);
  open_.clear();
  for (const Front::Index k : found_) open_.push_back(front.node(k).split);
  for (const SplitId first : open_)
    for (SplitId s = first; s != no_id && close_one(object, s, least);) s = hierarchy.node(s).parent;
}

bool FrontForest::is_closable(const Front& front, Front::Index k, float least) const {
  return front.is(k, Front::subtree_hidden) ||
         front.scales().error_factor[k] * front.error_at_most(k).quadric_px <= least;
}

bool FrontForest::close_one(std::uint32_t object, SplitId s, float least) {
  Front& front = evaluation_.front(object);
  const Front::Index k = front.find(s);
  if (k == Front::none || !front.is(k, Front::descended) || !is_closable(front, k, least)) return false;
  const SplitNode& split = evaluation_.scene().hierarchy(object).node(s);
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

}  // namespace occlod
