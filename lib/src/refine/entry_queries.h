// Which entries of the queue of refinement from scratch are asked about, when, and which are hidden.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "priority/queue.h"
#include "queries/occluder_steps.h"
#include "refine/refined_scene.h"

namespace occlod {

// An entry is asked about once for each occluder at most, and shortly before its turn comes. Reuses its memory.
class EntryQueries {
 public:
  void begin(const RefinedScene& scene);

  // How many occluders have been drawn.
  [[nodiscard]] std::uint32_t occluder() const noexcept { return occluder_; }
  // Entries that the occluder of their time hid.
  [[nodiscard]] std::span<const Entry> hidden() const noexcept { return hidden_; }
  [[nodiscard]] bool is_known_hidden(const Entry& entry) const noexcept {
    return entry.is_hidden && entry.asked_occluder == occluder_;
  }
  [[nodiscard]] bool must_ask(const Entry& entry) const {
    return occluder_ > 0 && entry.asked_occluder != occluder_ && queries_->asks(entry);
  }
  void hide(const Entry& entry);

  // Backends that want several questions under way. Whether this one could join them:
  [[nodiscard]] bool has_seat_for(const Entry& entry) const {
    return queries_->in_flights() && queries_->has_room() && must_ask(entry);
  }
  void ask(const Entry& entry) { queries_->ask(entry); }
  // From the top of the queue, those that matter.
  template <typename Matters>
  void fill_flight(Queue& queue, const Matters& matters);
  // The oldest entry asked about, if it is visible; else it joins the hidden ones.
  [[nodiscard]] std::optional<Entry> take_answer();
  // Takes all answers that are still under way, without acting on them.
  void drain(Queue& queue);

  // Backends that answer at once: about the next entry of the queue, and with it about those that will come next. None
  // is acted upon before its turn.
  template <typename Matters>
  void ask_ahead(Queue& queue, const Matters& matters);

  // When it is time for an occluder.
  [[nodiscard]] OccluderSteps& steps() noexcept { return steps_; }
  // The cuts as they are. Where options say so, what older ones hid is put back into the queue.
  void draw_occluder(Queue& queue, const Growth& now);
  // Asks about all that is hidden before an occluder drawn now; what it shows is put into the queue. Returns how many.
  std::size_t ask_again_about_hidden(Queue& queue, const Growth& now);

 private:
  void forget_verdict(const Entry& entry) const;
  void ask_all(std::span<Entry* const> entries);

  RefinedScene scene_;
  OcclusionQueries* queries_ = nullptr;
  OccluderSteps steps_;
  std::uint32_t occluder_ = 0;
  std::vector<Entry> hidden_;
  // Scratch: what earlier occluders hid; about which many questions are asked at once, and where that is kept.
  std::vector<Entry> doubtful_, asked_;
  std::vector<Entry*> asked_entries_;
};

template <typename Matters>
void EntryQueries::fill_flight(Queue& queue, const Matters& matters) {
  if (!queries_->in_flights()) return;
  while (!queue.empty() && queries_->has_room() && matters(queue.top()) && must_ask(queue.top())) ask(queue.pop());
}

// A backend that answers at once has less to do with many questions than with each of them.
template <typename Matters>
void EntryQueries::ask_ahead(Queue& queue, const Matters& matters) {
  if (queries_->in_flights() || !must_ask(queue.top())) return;
  constexpr std::size_t most_entries = 24;  // looked at
  asked_entries_.clear();
  std::size_t entries_left = most_entries;
  queue.for_top([&](Entry& entry) {
    if (entry.asked_occluder == occluder_) return --entries_left > 0;
    if (!matters(entry)) return false;
    if (must_ask(entry)) {
      asked_entries_.push_back(&entry);
    } else {  // nobody has to look at it again
      entry.asked_occluder = occluder_;
      entry.is_hidden = false;
    }
    return --entries_left > 0;
  });
  ask_all(asked_entries_);
}

}  // namespace occlod
