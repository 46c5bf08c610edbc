// Which entries of the queues of refinement from scratch are asked about, when, and which are hidden.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "refine/occluder_steps.h"
#include "refine/entry_queues.h"
#include "refine/refined_scene.h"

namespace occlod {

// An entry is asked about once for each occluder at most, when its turn comes. Reuses its memory.
class EntryQueries {
 public:
  void begin(const RefinedScene& scene);

  // How many occluders have been drawn.
  [[nodiscard]] std::uint32_t occluder() const noexcept { return occluder_; }
  // Entries that the occluder of their time hid.
  [[nodiscard]] std::span<const Entry> hidden() const noexcept { return hidden_; }
  // Some entries, and what is asked about them. Reuses its memory.
  struct Questions {
    std::vector<Entry> asked;
    std::vector<std::size_t> places;  // of these among all
    std::vector<OcclusionQueries::Verdict> verdicts;
    OcclusionQueries::Scratch scratch;
    double milliseconds = 0.0;  // that it took
  };
  // Asks about those that must be asked about. What is hidden is taken out; the others stay in their order. Then
  // note_answers() is to be called. On any thread, where many may ask; only the time of the caller's own counts.
  void take_out_hidden(std::vector<Entry>& entries, Questions& questions) const;
  void note_answers(const Questions& questions, bool own_time = true);

  // When it is time for an occluder.
  [[nodiscard]] OccluderSteps& steps() noexcept { return steps_; }
  // The cuts as they are. Where options say so, what older ones hid is put back into the queues.
  void draw_occluder(EntryQueues& queues, const Growth& now);
  // Asks about all that is hidden before an occluder drawn now; what it shows is put into the queues. Returns how many.
  std::size_t ask_again_about_hidden(EntryQueues& queues, const Growth& now);

 private:
  [[nodiscard]] bool must_ask(const Entry& entry) const {
    return entry.asked_occluder != occluder_ && queries_->asks(entry);
  }
  void hide(const Entry& entry);
  void forget_verdict(const Entry& entry) const;

  RefinedScene scene_;
  OcclusionQueries* queries_ = nullptr;
  OccluderSteps steps_;
  std::uint32_t occluder_ = 0;
  std::vector<Entry> hidden_;
  std::vector<Entry> doubtful_;  // scratch: what earlier occluders hid
  Questions about_doubtful_;
};

}  // namespace occlod
