// What refinement from scratch asks of a backend.
#include "queries/query_shape.h"
#include "refine/from_scratch.h"

namespace occlod {

bool FromScratch::must_ask(const Entry& entry) const {
  if (occluder_ == 0 || entry.asked_occluder == occluder_) return false;
  if (entry.kind == Entry::Kind::apply ? !options_->queries.ask_stars
                                       : entry.level % options_->queries.level_step != options_->queries.level_step - 1)
    return false;
  return refined_.gate->asks(entry.object, refined_.cuts[entry.object].hierarchy().node(entry.split).sphere.center);
}

void FromScratch::ask(const Entry& entry) {
  questions_->ask(entry, query_about(entry, refined_.cuts[entry.object].hierarchy(), options_->queries.proxy, star_));
  ++stats_->queries;
}

// From the global queue.
void FromScratch::fill_flight() {
  while (!queue_.empty() && questions_->has_room() && matters(queue_.top()) && must_ask(queue_.top()))
    ask(queue_.pop());
}

// About the next entry of the queue, and with it about those that will come next: a backend that answers at once has
// less to do with many questions than with each of them. None is acted upon before its turn.
void FromScratch::ask_ahead() {
  constexpr std::size_t most_entries = 24;  // looked at
  asked_.clear();
  asked_entries_.clear();
  std::size_t entries_left = most_entries;
  queue_.for_top([&](Entry& entry) {
    if (entry.asked_occluder == occluder_) return --entries_left > 0;
    if (!matters(entry)) return false;
    if (must_ask(entry)) {
      asked_.push_back(entry);
      asked_entries_.push_back(&entry);
    } else {  // nobody has to look at it again
      entry.asked_occluder = occluder_;
      entry.is_hidden = false;
    }
    return --entries_left > 0;
  });
  std::size_t answers = 0;
  ask_all([&](const Entry&, bool visible) {
    Entry& entry = *asked_entries_[answers++];
    entry.asked_occluder = occluder_;
    entry.is_hidden = !visible;
  });
}

// About all of asked_; calls answered(Entry, visible) for each.
template <typename Answered>
void FromScratch::ask_all(const Answered& answered) {
  stats_->queries += asked_.size();
  questions_->ask_all(
      asked_,
      [&](const Entry& entry) {
        return query_about(entry, refined_.cuts[entry.object].hierarchy(), options_->queries.proxy, star_);
      },
      [&](const Entry& entry, bool visible) {
        note_answer(entry, visible);
        answered(entry, visible);
      });
}

void FromScratch::note_answer(const Entry& entry, bool visible) {
  const glm::vec3& center = refined_.cuts[entry.object].hierarchy().node(entry.split).sphere.center;
  refined_.gate->answered(entry.object, entry.kind, center, entry.error.quadric_px, visible);
  if (!visible) ++stats_->queries_hidden;
}

// It joins the hidden ones.
void FromScratch::hide(const Entry& entry) {
  hidden_.push_back(entry);
  if (entry.kind == Entry::Kind::apply) refined_.importances[entry.object].set_hidden(entry.split, true);
}

// Takes the oldest answer; what is visible is processed if its turn is still now.
void FromScratch::settle() {
  Entry entry = take_answer();
  if (entry.split == no_id) return;
  if (matters(entry) && queue_.would_be_next(entry))
    process(entry);
  else
    queue_.push(entry);
}

// Takes all answers that are still under way, without acting on them.
void FromScratch::drain() {
  while (!questions_->none_open()) settle_later();
}

void FromScratch::settle_later() {
  const Entry entry = take_answer();
  if (entry.split != no_id) queue_.push(entry);
}

// The oldest entry asked about, if it is visible; else it joins the hidden ones and no entry comes back.
Entry FromScratch::take_answer() {
  Questions::Answer answer = questions_->take();
  note_answer(answer.entry, answer.visible);
  if (!answer.visible) {
    hide(answer.entry);
    return {};
  }
  answer.entry.asked_occluder = occluder_;
  answer.entry.is_hidden = false;
  return answer.entry;
}

// At its step, and when all that is left is hidden by an occluder that has since been refined.
bool FromScratch::occluder_due() const {
  if (!questions_->can_hide() || level_) return false;
  if (steps_.due(growth())) return true;
  return options_->occluder.retest_hidden && queue_.empty() && questions_->none_open() && !hidden_.empty() &&
         stats_->splits > steps_.last().splits;
}

void FromScratch::draw_occluder() {
  questions_->draw_occluder(
      occluder_mesh_->build(refined_.objects, refined_.cuts, refined_.views, options_->occluder.mode));
  steps_.drawn(growth());
  ++occluder_;
  ++stats_->occluder_draws;
  if (!options_->occluder.retest_hidden) return;
  for (const Entry& entry : hidden_) {  // (sec. 3.2)
    doubt(entry);
    queue_.push(entry);
  }
  hidden_.clear();
}

// What earlier occluders hid, before the one drawn last.
void FromScratch::ask_about_doubtful() {
  for (const Entry& entry : doubtful_) doubt(entry);
  asked_.assign(doubtful_.begin(), doubtful_.end());
  ask_all([&](const Entry& entry, bool visible) {
    if (!visible) {
      hide(entry);
      return;
    }
    Entry shown = entry;
    shown.asked_occluder = occluder_;
    shown.is_hidden = false;
    queue_.push(shown);
  });
}

// An older occluder hid it: that is no longer held to be true.
void FromScratch::doubt(const Entry& entry) const {
  if (entry.kind == Entry::Kind::apply) refined_.importances[entry.object].set_hidden(entry.split, false);
}

}  // namespace occlod
