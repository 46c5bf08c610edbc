#include "refine/victims.h"

#include <algorithm>

namespace occlod {
namespace {

// For a heap with the least important on top; ties by object and split, fine ones first.
bool less_urgent(const Victims::Victim& a, const Victims::Victim& b) {
  if (a.priority != b.priority) return a.priority > b.priority;
  if (a.object != b.object) return a.object > b.object;
  return a.split < b.split;
}

}  // namespace

void Victims::clear() noexcept {
  heap_.clear();
  gathered_ = false;
}

void Victims::gather(const CutSet& cuts, std::span<Importance> importances) {
  clear();
  for (std::uint32_t i = 0; i < cuts.size(); ++i) {
    leaves_.clear();
    for (const SplitId s : cuts[i].applied_splits())
      if (cuts[i].applied(s) && cuts[i].is_leaf(s)) leaves_.push_back(s);
    values_.resize(leaves_.size());
    importances[i].find(leaves_, values_);
    for (std::size_t k = 0; k < leaves_.size(); ++k)
      heap_.push_back({i, leaves_[k], values_[k].priority, values_[k].error});
  }
  std::make_heap(heap_.begin(), heap_.end(), less_urgent);
  gathered_ = true;
}

std::optional<Victims::Victim> Victims::take_back_below(float priority, CutSet& cuts,
                                                        std::span<Importance> importances) {
  while (!heap_.empty() && heap_.front().priority < priority) {
    std::pop_heap(heap_.begin(), heap_.end(), less_urgent);
    const Victim victim = heap_.back();
    heap_.pop_back();
    const Cut& cut = cuts[victim.object];
    if (!cut.applied(victim.split) || !cut.is_leaf(victim.split)) continue;  // since it was put here
    cuts.take_back(victim.object, victim.split,
                   [&](SplitId needed) { push(victim.object, needed, importances[victim.object]); });
    return victim;
  }
  return std::nullopt;
}

void Victims::push(std::uint32_t object, SplitId s, Importance& importance) {
  const Importance::Value value = importance.of(s);
  heap_.push_back({object, s, value.priority, value.error});
  std::push_heap(heap_.begin(), heap_.end(), less_urgent);
}

}  // namespace occlod
