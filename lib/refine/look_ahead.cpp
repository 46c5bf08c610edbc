// Looks at many candidates together before they are exchanged one after the other: asks about them and descends those
// that show, in vectors, on all threads, and without waiting for the memory each time.
#include <algorithm>

#include "refine/frames.h"
#include "refine/refined_scene.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

constexpr std::size_t min_ahead = 64, max_ahead = 4096;

// Calls visit(object, entries) for runs of entries of the same object.
template <typename Visit>
void for_each_object(std::span<Entry> entries, const Visit& visit) {
  for (std::size_t first = 0, end = 0; first < entries.size(); first = end) {
    while (end < entries.size() && entries[end].object == entries[first].object) ++end;
    visit(entries[first].object, entries.subspan(first, end - first));
  }
}

void sort_by_object(std::span<Entry> entries) {
  const auto before = [](const Entry& a, const Entry& b) { return a.object < b.object; };
  if (!std::is_sorted(entries.begin(), entries.end(), before)) std::stable_sort(entries.begin(), entries.end(), before);
}

}  // namespace

std::size_t SplitExchange::candidates_at_once() const {
  const RefineOptions* const options = evaluation_.scene().options;
  // A limit counts what is exchanged, or ends the frame soon.
  if (options->max_changes > 0 || options->time_limit_ms > 0.0) return min_ahead;
  return std::clamp(changes_before_, min_ahead, max_ahead);
}

bool SplitExchange::is_looked_at(const Entry& entry) const { return entry.asked_occluder == queries_.occluder(); }

// Looks at the most important candidates, and at what comes before the last of them.
void SplitExchange::look_ahead() {
  looked_at_.clear();
  take_ahead();
  const float least = ahead_.back().priority;
  while (!ahead_.empty()) {
    stats_->visits += ahead_.size();
    queries_.drop_hidden(ahead_);
    descend_ahead(least);
  }
  for (Entry& entry : looked_at_) {
    entry.asked_occluder = queries_.occluder();
    candidates_.push(entry);
  }
}

// Takes candidates that have not been looked at, as many as the frame before made changes, later fewer. Precondition:
// that holds for the first candidate.
void SplitExchange::take_ahead() {
  for (std::size_t left = next_ahead_; left > 0; --left) {
    if (candidates_.empty() || candidates_.top().priority <= candidates_above_) break;
    const Entry entry = candidates_.pop();
    (is_looked_at(entry) ? looked_at_ : ahead_).push_back(entry);
  }
  next_ahead_ = min_ahead;
}

// Descends what is visited in ahead_, and leaves there what is found above `least`. Splits have been looked at then.
void SplitExchange::descend_ahead(float least) {
  visits_.clear();
  for (const Entry& entry : ahead_) (entry.kind == Entry::Kind::visit ? visits_ : looked_at_).push_back(entry);
  ahead_.clear();
  sort_by_object(visits_);
  for_each_object(visits_, [&](std::uint32_t object, std::span<Entry> visits) { descend_all(object, visits, least); });
}

void SplitExchange::descend_all(std::uint32_t object, std::span<const Entry> visits, float least) {
  const auto put = [&](const std::optional<Entry>& entry) {
    if (!entry) return;
    if (entry->priority > least)
      ahead_.push_back(*entry);
    else
      candidates_.push(*entry);
  };
  const Front& front = evaluation_.front(object);
  sorted_.clear();
  for (const Entry& entry : visits)
    if (!front.is(front.find(entry.split), Front::descended)) sorted_.push_back(entry.split);
  std::sort(sorted_.begin(), sorted_.end());
  sorted_.erase(std::unique(sorted_.begin(), sorted_.end()), sorted_.end());
  for (const Front::Index k : forest_.descend(object, sorted_)) put(visit_of(object, k));
  found_.clear();
  for (const SplitId s : sorted_)
    if (const Front::Index k = front.find(s); !front.is(k, Front::applied)) found_.push_back(k);
  find_worths(object);
  for (std::size_t i = 0; i < found_.size(); ++i) put(split_of(object, found_[i], worths_[i]));
}

}  // namespace occlod
