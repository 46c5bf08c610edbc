#include "cut.h"

#include <algorithm>
#include <cassert>

namespace occlod {

Cut::Cut(const Hierarchy& hierarchy)
    : hierarchy_(&hierarchy),
      state_(hierarchy.split_count(), coarse_state),
      triangles_(hierarchy.base_triangle_count()) {}

void Cut::clear() {
  for (const SplitId s : applied_) state_[s] = coarse_state;
  applied_.clear();
  triangles_ = hierarchy_->base_triangle_count();
}

Cut::Closure Cut::closure(SplitId s) {
  assert(!applied(s));
  closure_.assign(1, s);
  state_[s] = in_closure_state;
  closure_gain_ = 0;
  // closure_ is both the result and the queue of what is still to be looked at.
  for (std::size_t i = 0; i < closure_.size(); ++i) {
    const SplitId t = closure_[i];
    closure_gain_ += static_cast<std::ptrdiff_t>(hierarchy_->inserted_count(t)) -
                     static_cast<std::ptrdiff_t>(hierarchy_->removed(t).size());
    for (const SplitId needed : hierarchy_->dependencies(t))
      if (state_[needed] == coarse_state) {
        state_[needed] = in_closure_state;
        closure_.push_back(needed);
      }
  }
  for (const SplitId t : closure_) state_[t] = coarse_state;
  return {closure_, static_cast<std::size_t>(std::max<std::ptrdiff_t>(closure_gain_, 0))};
}

void Cut::apply_closure() {
  for (const SplitId s : closure_) state_[s] = applied_state;
  applied_.insert(applied_.end(), closure_.begin(), closure_.end());
  triangles_ = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(triangles_) + closure_gain_);
  closure_.clear();
  closure_gain_ = 0;
}

void Cut::active_faces(std::vector<FaceId>& out, bool sorted) {
  out.clear();
  if (sorted) std::sort(applied_.begin(), applied_.end());
  const HierarchyData& data = hierarchy_->data();
  const auto add_active = [&](FaceId first, FaceId end) {
    for (FaceId f = first; f < end; ++f)
      if (data.died[f] == no_id || state_[data.died[f]] != applied_state) out.push_back(f);
  };
  add_active(0, static_cast<FaceId>(hierarchy_->base_triangle_count()));
  for (const SplitId s : applied_) add_active(data.nodes[s].first_inserted, data.nodes[s + 1].first_inserted);
  assert(out.size() == triangles_);
}

}  // namespace occlod
