#include "refine/entry_queries.h"

#include "base/milliseconds_since.h"

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

void EntryQueries::take_out_hidden(std::vector<Entry>& entries, Questions& questions) const {
  auto& [asked, places, verdicts, scratch, milliseconds] = questions;
  const Clock::time_point start = Clock::now();
  asked.clear();
  places.clear();
  milliseconds = 0.0;
  if (occluder_ == 0) return;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!must_ask(entries[i])) continue;
    asked.push_back(entries[i]);
    places.push_back(i);
  }
  if (asked.empty()) return;
  verdicts.resize(asked.size());
  queries_->find(asked, verdicts, scratch);
  std::size_t next = 0, kept = places.front();
  for (std::size_t i = kept; i < entries.size(); ++i) {
    Entry entry = entries[i];
    if (next < places.size() && places[next] == i) {
      const OcclusionQueries::Verdict& verdict = verdicts[next++];
      if (!verdict.visible) continue;
      entry.asked_occluder = occluder_;
      entry.star_shows = verdict.vertex_shows;
    }
    entries[kept++] = entry;
  }
  entries.resize(kept);
  milliseconds = milliseconds_since(start);
}

void EntryQueries::note_answers(const Questions& questions, bool own_time) {
  queries_->count(questions.asked, questions.verdicts, own_time ? questions.milliseconds : 0.0);
  for (std::size_t i = 0; i < questions.asked.size(); ++i)
    if (!questions.verdicts[i].visible) hide(questions.asked[i]);
}

void EntryQueries::draw_occluder(EntryQueues& queues, const Growth& now) {
  const RefineOptions* const options = scene_.options;
  queries_->draw_occluder(*scene_.cuts);
  steps_.drawn(now);
  ++occluder_;
  if (!options->occluder.retest_hidden) return;
  for (const Entry& entry : hidden_) {  // (Birkholz & Rahn, sec. 3.2)
    forget_verdict(entry);
    queues.push(entry);
  }
  hidden_.clear();
}

std::size_t EntryQueries::ask_again_about_hidden(EntryQueues& queues, const Growth& now) {
  doubtful_.clear();
  doubtful_.swap(hidden_);
  draw_occluder(queues, now);
  for (const Entry& entry : doubtful_) forget_verdict(entry);
  take_out_hidden(doubtful_, about_doubtful_);
  note_answers(about_doubtful_);
  for (const Entry& entry : doubtful_) queues.push(entry);
  return doubtful_.size();
}

}  // namespace occlod
