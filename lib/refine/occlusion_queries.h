// What refinement asks a backend: the rules by which it asks, its questions, and the occluder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "refine/cut_set.h"
#include "occlod/refine/refiner.h"
#include "occlod/refine/visibility.h"
#include "refine/entry.h"
#include "refine/effect_gate.h"
#include "refine/occluder.h"

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

// Each answer is told to the gate. Reuses its memory.
class OcclusionQueries {
 public:
  void begin(Visibility& visibility, const QueriedScene& scene);

  [[nodiscard]] bool can_hide() const noexcept { return can_hide_; }
  // How many questions should be asked at once, at least.
  [[nodiscard]] std::size_t flight() const noexcept { return flight_; }
  // Whether one question is waited for nearly as long as many.
  [[nodiscard]] bool in_flights() const noexcept { return flight_ > 1; }

  // Whether the options let this question be asked: by its kind, its level in the forest and its region.
  [[nodiscard]] bool asks(const Entry& entry) const;
  // Whether the options let anything about this split be asked.
  [[nodiscard]] bool asks_in_region(std::uint32_t object, SplitId s) const;
  // Whether stars are asked about; and whether splits are, before and while they are applied.
  [[nodiscard]] bool asks_stars() const;
  [[nodiscard]] bool asks_splits() const;
  // What is asked about a split to know whether it should be applied.
  [[nodiscard]] Entry::Kind split_question() const;

  struct Verdict {
    bool visible = true;
    bool vertex_shows = false;  // that the split brings back: its own star is visible too
  };
  // Reuses its memory.
  struct Scratch {
    std::vector<glm::vec3> vertices;
    std::vector<std::uint8_t> vertex_shows;
    // Of what is asked about by bounds: its place, and where its points begin if it is a star.
    std::vector<std::size_t> asked, first_points;
    std::vector<glm::vec3> points;
    std::vector<VisibilityQuery> queries;
    std::vector<std::uint32_t> answers;
  };
  // Asks about each of them; `verdicts` has as many places. Several threads may, each with a scratch of its own, where
  // the backend says so; then the answers are to be counted.
  void find(std::span<const Entry> entries, std::span<Verdict> verdicts, Scratch& scratch) const;
  // entry.error tells the gate what a hidden subtree is worth. `milliseconds`: that the caller has spent on them.
  void count(std::span<const Entry> entries, std::span<const Verdict> verdicts, double milliseconds);
  // Both, and the time that it takes.
  void ask(std::span<const Entry> entries, std::span<Verdict> verdicts);
  [[nodiscard]] bool many_threads_may_ask() const noexcept { return visibility_->answers_many_threads(); }
  // The cuts as they are.
  void draw_occluder(CutSet& cuts);

  // In this view.
  struct Counts {
    std::size_t asked = 0;
    std::size_t hidden = 0;
    std::size_t draws = 0;
  };
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }
  // Spent on questions and occluders.
  [[nodiscard]] double milliseconds() const noexcept { return milliseconds_; }

 private:
  void find_vertices_that_show(std::span<const Entry> entries, std::span<Verdict> verdicts, Scratch& scratch) const;
  void ask_about_bounds(std::span<const Entry> entries, std::span<Verdict> verdicts, Scratch& scratch) const;
  [[nodiscard]] VisibilityQuery query_about(const Entry& entry) const;

  Visibility* visibility_ = nullptr;
  QueriedScene scene_;
  bool can_hide_ = false;
  std::size_t flight_ = 1;  // of the backend, in this view
  Counts counts_;
  double milliseconds_ = 0.0;
  Occluder occluder_;
  Scratch scratch_;
};

}  // namespace occlod
