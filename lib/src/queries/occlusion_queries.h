// What refinement asks a backend: the rules by which it asks, questions under way, and the occluder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/milliseconds_since.h"
#include "cut/cut_set.h"
#include "occlod/refine/refiner.h"
#include "occlod/refine/visibility.h"
#include "priority/entry.h"
#include "priority/star_visibility.h"
#include "queries/effect_gate.h"
#include "queries/occluder.h"

namespace occlod {

// What is asked about in one view. All outlive it.
struct QueriedScene {
  std::span<const RefineObject> objects;
  std::span<const ObjectView> views;
  const CutSet* cuts = nullptr;
  EffectGate* gate = nullptr;
  const View* view = nullptr;
  const RefineOptions* options = nullptr;
};

// Answers come in the order of the questions, and each is told to the gate. Reuses its memory.
class OcclusionQueries {
 public:
  void begin(Visibility& visibility, const QueriedScene& scene);

  [[nodiscard]] bool can_hide() const noexcept { return can_hide_; }
  [[nodiscard]] bool none_open() const noexcept { return answered_ == open_.size(); }
  [[nodiscard]] bool has_room() const noexcept { return open_.size() - answered_ < flight_; }
  // Whether several questions should be under way at once.
  [[nodiscard]] bool in_flights() const { return flight_ > 1; }

  // Whether the options let this question be asked: by its kind, its level in the forest and its region.
  [[nodiscard]] bool asks(const Entry& entry) const;
  // Whether the options let anything about this split be asked.
  [[nodiscard]] bool asks_in_region(std::uint32_t object, SplitId s) const;
  // Whether stars are asked about; and whether splits are, before and while they are applied.
  [[nodiscard]] bool asks_stars() const;
  [[nodiscard]] bool asks_splits() const;
  // What is asked about a split to know whether it should be applied.
  [[nodiscard]] Entry::Kind split_question() const;

  // entry.error tells the gate what a hidden subtree is worth.
  void ask(const Entry& entry);
  struct Answer {
    Entry entry;
    bool visible = true;
  };
  // To the oldest question. Precondition: one is open.
  [[nodiscard]] Answer take();
  // Asks about each of `entries`, as many at once as the backend likes, and calls answered(entry, visible) in their
  // order. Precondition: none is open.
  template <typename Answered>
  void ask_all(std::span<const Entry> entries, const Answered& answered);
  // The cuts as they are. Precondition: none is open.
  void draw_occluder(CutSet& cuts);

  // In this view.
  struct Counts {
    std::size_t asked = 0;
    std::size_t hidden = 0;
    std::size_t draws = 0;
  };
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }
  // Spent in the backend.
  [[nodiscard]] double milliseconds() const noexcept { return milliseconds_; }

 private:
  void submit(const Entry& entry);
  [[nodiscard]] bool collect(const Entry& entry);

  Visibility* visibility_ = nullptr;
  QueriedScene scene_;
  bool can_hide_ = false;
  std::size_t flight_ = 1;   // of the backend, in this view
  std::vector<Entry> open_;  // oldest first, after those that are answered
  std::size_t answered_ = 0;
  Clock::time_point asked_;  // the last of them
  Counts counts_;
  double milliseconds_ = 0.0;
  Occluder occluder_;
  StarVisibility star_;
};

template <typename Answered>
void OcclusionQueries::ask_all(std::span<const Entry> entries, const Answered& answered) {
  const Clock::time_point start = Clock::now();
  const std::size_t most_open = in_flights() ? flight_ : entries.size();
  std::size_t answers = 0;
  const auto take_one = [&] {
    const Entry& entry = entries[answers++];
    answered(entry, collect(entry));
  };
  for (std::size_t asked = 0; asked < entries.size(); ++asked) {
    if (asked - answers >= most_open) take_one();
    submit(entries[asked]);
  }
  while (answers < entries.size()) take_one();
  milliseconds_ += milliseconds_since(start);
}

}  // namespace occlod
