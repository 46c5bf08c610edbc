// Asks a backend what is hidden, where the options allow it, and counts the answers by object and region.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/refiner.h"
#include "occlod/visibility.h"
#include "refine/cut.h"
#include "refine/occluder.h"
#include "refine/queue.h"

namespace occlod {

// Finds the cell of effect_regions_per_axis^3 over `box` that holds a point; points outside belong to the cell next to
// them.
class RegionGrid {
 public:
  explicit RegionGrid(const Box& box);
  [[nodiscard]] std::size_t region_of(const glm::vec3& p) const noexcept;

 private:
  glm::vec3 min_;
  glm::vec3 cells_per_unit_;
};

inline std::size_t RegionGrid::region_of(const glm::vec3& p) const noexcept {
  const auto cell = [&](int axis) {
    constexpr int last = effect_regions_per_axis - 1;
    const float at = (p[axis] - min_[axis]) * cells_per_unit_[axis];
    return static_cast<std::size_t>(std::clamp(at, 0.0F, static_cast<float>(last)));
  };
  return cell(0) + effect_regions_per_axis * (cell(1) + effect_regions_per_axis * cell(2));
}

// Allows the tests that the options switch on, by object and region, and counts them. Reuses its memory from view to
// view.
class EffectGate {
 public:
  // Starts a view. Throws Error unless options.effects is empty or has one element per object.
  void begin(std::span<const RefineObject> objects, const RefineOptions& options);

  [[nodiscard]] bool tests_cone(std::uint32_t object) const noexcept { return objects_[object].tests_cone; }
  // Counts a test and returns its outcome.
  bool cone_culled(std::uint32_t object, bool culled) noexcept {
    ++stats_[object].cone_tests;
    stats_[object].cone_culled += culled ? 1 : 0;
    return culled;
  }
  // Returns whether the options allow questions everywhere in the object.
  [[nodiscard]] bool asks_everywhere(std::uint32_t object) const noexcept {
    return objects_[object].regions == all_effect_regions;
  }
  // Returns whether the options allow questions around `center` (object space).
  [[nodiscard]] bool asks(std::uint32_t object, const glm::vec3& center) const noexcept {
    const std::uint64_t regions = objects_[object].regions;
    return regions != 0 && ((regions >> objects_[object].grid.region_of(center)) & 1U) != 0;
  }
  [[nodiscard]] std::size_t region_of(std::uint32_t object, const glm::vec3& center) const noexcept {
    return objects_[object].grid.region_of(center);
  }
  // Counts the answer about a star or subtree in a region whose error is error_px.
  void answered(std::uint32_t object, Entry::Kind kind, std::size_t in_region, float error_px, bool visible) noexcept {
    using Region = ObjectEffectStats::Region;
    Region& region = stats_[object].regions[in_region];
    ++region.queries;
    if (visible) return;
    ++region.hidden;
    if (kind == Entry::Kind::apply)
      ++region.hidden_stars;
    else
      region.hidden_subtrees_px += std::min(error_px, Region::max_error_px);
  }
  [[nodiscard]] std::span<const ObjectEffectStats> stats() const noexcept { return stats_; }

 private:
  struct Object {
    RegionGrid grid;
    std::uint64_t regions = all_effect_regions;
    bool tests_cone = true;
  };
  std::vector<Object> objects_;
  std::vector<ObjectEffectStats> stats_;
};

// Refers to what is asked about in one view. All of it must outlive the questions.
struct QueriedScene {
  std::span<const RefineObject> objects;
  std::span<const ObjectView> views;
  const CutSet* cuts = nullptr;
  EffectGate* gate = nullptr;
  const View* view = nullptr;
  const RefineOptions* options = nullptr;
  unsigned threads = 1;  // that may work on it
};

// Asks a backend by the rules of the options, draws its occluders, and tells each answer to the gate. Reuses its
// memory.
class OcclusionQueries {
 public:
  void begin(Visibility& visibility, const QueriedScene& scene);

  [[nodiscard]] bool can_hide() const noexcept { return can_hide_; }
  // Returns how many questions should be asked at once, at least.
  [[nodiscard]] std::size_t flight() const noexcept { return flight_; }
  // Returns whether waiting for one answer takes nearly as long as for many.
  [[nodiscard]] bool in_flights() const noexcept { return flight_ > 1; }

  // Returns whether the options let this question be asked: by its kind, its level in the forest and its region.
  [[nodiscard]] bool asks(const Entry& entry) const;
  // Returns whether the options let something be asked about every split of the object.
  [[nodiscard]] bool asks_everywhere(std::uint32_t object) const { return scene_.gate->asks_everywhere(object); }
  // Returns whether the options let anything about this split be asked.
  [[nodiscard]] bool asks_in_region(std::uint32_t object, SplitId s) const;
  // Return whether stars are asked about, and whether splits are, before and while they are applied.
  [[nodiscard]] bool asks_stars() const;
  [[nodiscard]] bool asks_splits() const;
  // Returns the question that decides whether a split should be applied.
  [[nodiscard]] Entry::Kind split_question() const;

  struct Verdict {
    bool visible = true;
    bool vertex_shows = false;  // whether the vertex that the split brings back shows: then its own star is visible too
    // Whether something else is before this vertex, or it is beside the image, though the star is visible. About stars
    // only, and only where the backend tests points.
    bool covered = false;
    std::uint8_t region = 0;  // of the object that was asked about
  };
  // Holds scratch memory of find().
  struct Scratch {
    std::vector<glm::vec3> vertices;
    std::vector<std::uint8_t> vertex_shows;
    // For entries asked about by bounds: their indices, and where the points of stars begin.
    std::vector<std::size_t> asked, first_points;
    std::vector<glm::vec3> points;
    std::vector<VisibilityQuery> queries;
    std::vector<std::uint32_t> answers;
  };
  // Asks about each entry; `verdicts` has the size of `entries`. Several threads may call this where the backend allows
  // it, each with its own scratch. count() must follow.
  void find(std::span<const Entry> entries, std::span<Verdict> verdicts, Scratch& scratch) const;
  // Counts answers. entry.error tells the gate what a hidden subtree is worth; the caller has spent `milliseconds` on
  // them.
  void count(std::span<const Entry> entries, std::span<const Verdict> verdicts, double milliseconds);
  // Calls find(), on as many threads as the options allow, and count(), and measures the time.
  void ask(std::span<const Entry> entries, std::span<Verdict> verdicts);
  [[nodiscard]] bool many_threads_may_ask() const noexcept { return visibility_->answers_many_threads(); }
  // Returns whether the backend answers from a picture of an earlier view.
  [[nodiscard]] bool from_picture() const noexcept { return visibility_->has_picture(); }
  [[nodiscard]] bool has_occluder() const noexcept { return from_picture() || counts_.draws > 0; }
  // Draws the current cuts as the occluder.
  void draw_occluder(CutSet& cuts);

  // Counts of this view.
  struct Counts {
    std::size_t asked = 0;
    std::size_t hidden = 0;
    std::size_t draws = 0;
  };
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }
  // Returns the time spent on questions and occluders.
  [[nodiscard]] double milliseconds() const noexcept { return milliseconds_; }

 private:
  [[nodiscard]] std::uint8_t region_of(const Entry& entry) const;
  void find_vertices_that_show(std::span<const Entry> entries, std::span<Verdict> verdicts, Scratch& scratch) const;
  void prefetch_star(const Entry& entry) const noexcept;
  void prefetch_corners(const Entry& entry) const noexcept;
  void ask_about_bounds(std::span<const Entry> entries, std::span<Verdict> verdicts, Scratch& scratch) const;
  void find_covered(std::span<const Entry> entries, std::span<Verdict> verdicts, Scratch& scratch) const;
  [[nodiscard]] VisibilityQuery query_about(const Entry& entry) const;

  Visibility* visibility_ = nullptr;
  QueriedScene scene_;
  bool can_hide_ = false;
  std::size_t flight_ = 1;  // of the backend, in this view
  Counts counts_;
  double milliseconds_ = 0.0;
  Occluder occluder_;
  std::vector<Scratch> scratch_;  // by thread
};

}  // namespace occlod
