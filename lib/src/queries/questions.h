// What has been asked of a backend and is not answered yet.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/milliseconds_since.h"
#include "occlod/refine/visibility.h"
#include "priority/queue.h"

namespace occlod {

// Answers come in the order of the questions. Counts time spent in the backend.
class Questions {
 public:
  void begin(Visibility& visibility, const View& view, std::span<const ObjectView> objects);

  [[nodiscard]] bool can_hide() const noexcept { return can_hide_; }
  [[nodiscard]] bool none_open() const noexcept { return answered_ == open_.size(); }
  [[nodiscard]] bool has_room() const noexcept { return open_.size() - answered_ < flight_; }
  // Whether several questions should be under way at once.
  [[nodiscard]] bool in_flights() const { return flight_ > 1; }

  void ask(const Entry& entry, const VisibilityQuery& query);
  struct Answer {
    Entry entry;
    bool visible = true;
  };
  // To the oldest question. Precondition: one is open.
  [[nodiscard]] Answer take();
  // Asks about each of `entries`, as many at once as the backend likes, and calls answered(entry, visible) in their
  // order. query_of(entry) makes the question. Precondition: none is open.
  template <typename QueryOf, typename Answered>
  void ask_all(std::span<const Entry> entries, const QueryOf& query_of, const Answered& answered);
  // Precondition: none is open.
  void draw_occluder(std::span<const OccluderPart> parts);

  [[nodiscard]] double milliseconds() const noexcept { return milliseconds_; }

 private:
  Visibility* visibility_ = nullptr;
  bool can_hide_ = false;
  std::size_t flight_ = 1;   // of the backend, in this view
  std::vector<Entry> open_;  // oldest first, after those that are answered
  std::size_t answered_ = 0;
  Clock::time_point asked_;  // the last of them
  double milliseconds_ = 0.0;
};

template <typename QueryOf, typename Answered>
void Questions::ask_all(std::span<const Entry> entries, const QueryOf& query_of, const Answered& answered) {
  const Clock::time_point start = Clock::now();
  const std::size_t most_open = in_flights() ? flight_ : entries.size();
  std::size_t answers = 0;
  const auto take_one = [&] {
    const bool visible = visibility_->collect() != 0;
    answered(entries[answers++], visible);
  };
  for (std::size_t asked = 0; asked < entries.size(); ++asked) {
    if (asked - answers >= most_open) take_one();
    visibility_->submit(query_of(entries[asked]));
  }
  while (answers < entries.size()) take_one();
  milliseconds_ += milliseconds_since(start);
}

}  // namespace occlod
