// Samples how much of a scene is hidden, before or after it is refined.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "occlod/auto_refiner.h"
#include "occlod/refiner.h"
#include "refine/importance.h"
#include "refine/star_visibility.h"

namespace occlod {

// Queries its own backend at a fraction of the view's resolution, so that a look costs a small share of a frame. The
// answers only decide which queries are worth asking, so they need not be conservative.
class Probe {
 public:
  explicit Probe(std::span<const RefineObject> objects);
  Probe(const Probe&) = delete;
  Probe& operator=(const Probe&) = delete;
  ~Probe();

  // Places an object as Refiner::set_transform() does.
  void set_transform(std::size_t object, const glm::dmat4& object_to_world);

  struct Result {
    HiddenShares all;
    std::vector<HiddenShares> objects;
  };
  // Samples a view before it is refined, with a coarse mesh refined for this purpose as the occluder. Deterministic.
  const Result& look_ahead(const View& view, const RefineOptions& options);
  // Returns the priority at which refinement from scratch should use up its budget, from the last look ahead.
  [[nodiscard]] double level_ahead_px() const noexcept { return level_ahead_px_; }
  // Samples a view after it is refined, with the refined mesh as the occluder; its splits have priorities down to
  // level_px.
  const Result& look_back(const View& view, const RefineOptions& options, const Refinement& refinement,
                          double level_px);

 private:
  class SmallVisibility;
  // A node that a walk has reached.
  struct Step {
    std::uint32_t object = 0;
    SplitId split = no_id;
    float error_px = 0.0F;
    double stands_for = 1.0;  // number of nodes: one over the probability that a walk reaches it
  };
  struct Walk {
    Step at;
    double place = 0.0;  // decides its next step, in [0, 1)
  };
  // Adds up samples; all fields except the first two are weighted by what the samples stand for.
  struct Sums {
    std::size_t samples = 0;
    std::size_t split_samples = 0;
    double visits = 0.0;
    double visits_hidden = 0.0;
    double splits = 0.0;
    double splits_squared = 0.0;  // sum of the squared weights
    double splits_hidden = 0.0;
    double stars_hidden = 0.0;
    double seen = 0.0;        // splits that are not hidden
    double seen_finer = 0.0;  // these, and those below them down to half of the error

    void add(const Sums& o);
    [[nodiscard]] HiddenShares shares() const;
  };

  void begin(const View& view, const RefineOptions& options);
  void find_roots();
  void take_walks(std::size_t walks, double max_nodes);
  [[nodiscard]] Walk begin_walk(double place) const;
  void prefetch_children(const Step& at) const;
  [[nodiscard]] bool take_step(Walk& walk) const;
  [[nodiscard]] double level_of(std::size_t nodes);
  void count_walks(double level_px);
  [[nodiscard]] float error_px(std::uint32_t object, SplitId s) const;
  void count(std::span<const Step> path, float level_px);
  [[nodiscard]] bool is_worth(const Step& step, float level_px);
  void count_split(std::span<const Step> path, float level_px, Sums& sums);
  void count_visit(const Step& at, Sums& sums);

  std::vector<RefineObject> objects_;
  Refiner scout_;
  std::unique_ptr<SmallVisibility> visibility_;
  std::vector<ObjectView> views_;
  std::vector<Importance> importances_;
  RefineOptions options_;
  struct Root {
    Step node;
    double weight_until = 0.0;  // sum of the square roots of the errors up to this root
  };
  std::vector<Root> roots_;
  double root_step_ = 1.0;  // number of roots that each of them stands for
  std::vector<Walk> walks_;
  std::vector<std::vector<Step>> paths_;  // all steps of each walk, from a root on
  std::vector<std::size_t> active_;       // indices of walks that go on
  std::vector<Step> sorted_;
  StarVisibility star_;
  std::vector<std::vector<glm::vec3>> corners_;  // corners of the occluder of look_back(), by object
  std::vector<std::vector<Triangle>> corner_triangles_;
  std::vector<Sums> sums_;  // by object
  double level_ahead_px_ = 0.0;
  Result result_;
};

}  // namespace occlod
