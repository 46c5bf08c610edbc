// Holds the options of refinement that only experiments change: benchmarks, tests and the viewer's research panels.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "occlod/refiner.h"

namespace occlod {

// Selects the question that decides whether a split is applied.
enum class Culling {
  subtree,  // one question, as in the paper: may the bounds of its subtree be seen?
  star,  // two questions: descend where the bounds of the subtree may be seen, apply where the split's own faces may be
};

// Returns the name for tables of benchmarks.
[[nodiscard]] inline const char* name_of(Culling culling) noexcept {
  return culling == Culling::subtree ? "subtree" : "star";
}

// Selects the bounds of a subtree that occlusion queries ask about.
enum class Proxy { sphere, box, cylinder };

// With Culling::subtree the priority of a split is its error in pixels; with Culling::star that
// error * (visible share of its faces)^visible_exponent * (cosine under which the eye sees them)^-grazing_exponent
// * (1 + unseen splits that it forces)^-forced_exponent * (covered_factor, if its vertex is covered but not its star).
struct Tuning {
  // Changing one of these makes Refiner::update() refine from scratch.
  Culling culling = Culling::star;
  double visible_exponent = 1.0;    // in [0, 8]
  double grazing_exponent = 0.375;  // in [0, 8]
  double forced_exponent = 0.5;     // in [0, 8]
  double covered_factor = 0.25;     // in [0.001, 1]
  Proxy proxy = Proxy::box;
  // From scratch, the occluder is drawn when so many splits are applied; ascending. Empty: at a third of the budget in
  // triangles and at sixths of that, if the mesh has moved by a pixel since the one before.
  std::vector<std::uint32_t> occluder_splits = {};
  bool retest_hidden = true;  // from scratch: whenever a new occluder is drawn, ask again about what an older one hid

  // These may change from frame to frame.
  std::uint32_t level_step = 2;  // ask about subtrees on every n-th forest level; >= 1. 2: odd ones, as the paper, 3.3
  bool ask_stars = true;         // Culling::star: ask about each split's own faces before it is applied
  bool final_check = true;       // ask again about all that is hidden before the result, in update() only about large
                                 // errors; what turns out to be visible replaces splits of lower priority
  double hysteresis = 0.03;      // update(): relative margin by which a candidate must exceed an applied split; [0, 1)

  friend bool operator==(const Tuning&, const Tuning&) = default;
};

// Birkholz & Rahn ask one question per subtree (sec. 3.1), about bounding cylinders, with occluders after 300 and 2,500
// splits (sec. 4).
inline const Tuning paper_tuning{
    .culling = Culling::subtree, .proxy = Proxy::cylinder, .occluder_splits = {300, 2500}, .final_check = false};
inline const Tuning standard_tuning;

// Returns the tuning that these options refine with.
[[nodiscard]] inline const Tuning& tuning_of(const RefineOptions& options) noexcept {
  if (options.tuning) return *options.tuning;
  return options.method == Method::paper ? paper_tuning : standard_tuning;
}

// Returns a tuning that only these options use, to change single fields: tune(options).proxy = Proxy::sphere. Copies of
// the options do not change.
[[nodiscard]] inline Tuning& tune(RefineOptions& options) {
  auto own = std::make_shared<Tuning>(tuning_of(options));
  Tuning& tuning = *own;
  options.tuning = std::move(own);
  return tuning;
}

}  // namespace occlod
