#include "from_scratch.h"
#include "query_shape.h"

// What refinement from scratch asks of a backend.
namespace occlod {

// Into the flight if it has room for a question that must be asked, else into the global queue.
void FromScratch::offer(const Entry& entry) {
  if (questions_->in_flights() && questions_->has_room() && matters(entry) && must_ask(entry))
    ask(entry);
  else
    queue_.push(entry);
}

bool FromScratch::must_ask(const Entry& entry) const {
  if (occluder_ == 0 || entry.asked_occluder == occluder_) return false;
  if (!refined_.gate->asks(entry.object, refined_.cuts[entry.object].hierarchy().node(entry.split).sphere.center))
    return false;
  if (entry.kind == Entry::Kind::apply) return options_->ask_stars;
  return entry.level % options_->level_step == options_->level_step - 1;
}

void FromScratch::ask(const Entry& entry) {
  questions_->ask(entry, query_about(entry, refined_.cuts[entry.object].hierarchy(), options_->proxy, star_));
  ++stats_->queries;
}

// Takes the oldest answer; what is visible is processed if its turn is still now.
void FromScratch::settle() {
  const Entry entry = take_answer();
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
  refined_.gate->answered(answer.entry, refined_.cuts[answer.entry.object].hierarchy().node(answer.entry.split),
                          answer.visible);
  if (!answer.visible) {
    ++stats_->queries_hidden;
    hidden_.push_back(answer.entry);
    if (answer.entry.kind == Entry::Kind::apply)
      refined_.importances[answer.entry.object].set_hidden(answer.entry.split, true);
    return {};
  }
  answer.entry.asked_occluder = occluder_;
  return answer.entry;
}

// At its step, and when all that is left is hidden by an occluder that has since been refined.
bool FromScratch::occluder_due() const {
  if (!questions_->can_hide() || level_) return false;
  if (steps_.due(growth())) return true;
  return options_->retest_hidden && queue_.empty() && questions_->none_open() && !hidden_.empty() &&
         stats_->splits > steps_.last().splits;
}

void FromScratch::draw_occluder() {
  questions_->draw_occluder(
      occluder_mesh_->build(refined_.objects, refined_.cuts, refined_.views, options_->occluder_mode));
  steps_.drawn(growth());
  ++occluder_;
  ++stats_->occluder_draws;
  if (!options_->retest_hidden) return;
  for (const Entry& entry : hidden_) {  // (sec. 3.2)
    doubt(entry);
    queue_.push(entry);
  }
  hidden_.clear();
}

// An older occluder hid it: that is no longer held to be true.
void FromScratch::doubt(const Entry& entry) {
  if (entry.kind == Entry::Kind::apply) refined_.importances[entry.object].set_hidden(entry.split, false);
}

}  // namespace occlod
