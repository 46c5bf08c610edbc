#include "refine/entry_queries.h"

namespace occlod {

void EntryQueries::begin(const RefinedScene& scene) {
  scene_ = scene;
  queries_ = scene.queries;
  steps_.begin(*scene.options);
  occluder_ = 0;
  hidden_.clear();
}

void EntryQueries::hide(const Entry& entry) {
  hidden_.push_back(entry);
  if (entry.kind == Entry::Kind::apply) scene_.importances[entry.object].set_hidden(entry.split, true);
}

// An older occluder hid it: that is no longer held to be true.
void EntryQueries::forget_verdict(const Entry& entry) const {
  if (entry.kind == Entry::Kind::apply) scene_.importances[entry.object].set_hidden(entry.split, false);
}

std::optional<Entry> EntryQueries::take_answer() {
  OcclusionQueries::Answer answer = queries_->take();
  if (!answer.visible) {
    hide(answer.entry);
    return std::nullopt;
  }
  answer.entry.asked_occluder = occluder_;
  answer.entry.is_hidden = false;
  return answer.entry;
}

void EntryQueries::drain(Queue& queue) {
  while (!queries_->none_open())
    if (const std::optional<Entry> entry = take_answer()) queue.push(*entry);
}

void EntryQueries::ask_all(std::span<Entry* const> entries) {
  asked_.clear();
  for (const Entry* entry : entries) asked_.push_back(*entry);
  std::size_t answers = 0;
  queries_->ask_all(asked_, [&](const Entry&, bool visible) {
    Entry& entry = *entries[answers++];
    entry.asked_occluder = occluder_;
    entry.is_hidden = !visible;
  });
}

void EntryQueries::draw_occluder(Queue& queue, const Growth& now) {
  const RefineOptions* const options = scene_.options;
  queries_->draw_occluder(*scene_.cuts);
  steps_.drawn(now);
  ++occluder_;
  if (!options->occluder.retest_hidden) return;
  for (const Entry& entry : hidden_) {  // (Birkholz & Rahn, sec. 3.2)
    forget_verdict(entry);
    queue.push(entry);
  }
  hidden_.clear();
}

std::size_t EntryQueries::ask_again_about_hidden(Queue& queue, const Growth& now) {
  doubtful_.clear();
  doubtful_.swap(hidden_);
  draw_occluder(queue, now);
  asked_entries_.clear();
  for (Entry& entry : doubtful_) {
    forget_verdict(entry);
    asked_entries_.push_back(&entry);
  }
  ask_all(asked_entries_);
  for (const Entry& entry : doubtful_)
    if (entry.is_hidden)
      hide(entry);
    else
      queue.push(entry);
  return doubtful_.size() - hidden_.size();
}

}  // namespace occlod
