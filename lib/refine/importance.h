// Finds what applying a split is worth to one eye, and what it costs in triangles that this eye does not see.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.h"
#include "occlod/refiner.h"
#include "refine/screen_error.h"
#include "refine/star_visibility.h"

namespace occlod {

// Smaller cosines count as this one: nearly edge-on faces are narrower than a pixel.
inline constexpr float min_cosine = 0.2F;

// Evaluates the splits of one object. Reuses its memory from view to view.
class Importance {
 public:
  explicit Importance(const RefineObject& object);

  // Starts a view. Both arguments must outlive it.
  void begin(const ObjectView& view, const RefineOptions& options);

  struct Value {
    float visible_share = 0.0F;  // share of the split's faces; 0: the split changes nothing that is seen
    float priority = 0.0F;       // error in pixels, weighted by how the faces are seen
    ScreenError error;           // unweighted error
  };
  // Returns the value of s by its own star.
  [[nodiscard]] Value of(SplitId s) {
    Value value;
    find({&s, 1}, {&value, 1});
    return value;
  }
  // Finds the values of many splits, which costs less than one by one; `values` has the size of `splits`.
  void find(std::span<const SplitId> splits, std::span<Value> values);
  // Returns the value of a split with these errors whose star has been looked at.
  [[nodiscard]] Value of(const StarView& star, const SplitErrors& errors) const;
  // Stores the visible share of a star for this view.
  void remember(SplitId s, float visible_share);

  // Returns the factor by which the priority of closure[0] sinks for unseen stars among the other splits, which it
  // forces, in (0, 1].
  [[nodiscard]] float forced_weight(std::span<const SplitId> closure);
  // Returns the share of the star of s that is seen, from memory if it is known in this view.
  [[nodiscard]] float visible_share(SplitId s);
  [[nodiscard]] bool knows_share(SplitId s) const noexcept { return shares_[s] != 0; }
  // Finds the shares of all these splits that are not known yet. Each may occur several times.
  void find_shares(std::span<const SplitId> splits);
  // Records that the occluder hides all of the star of s, or no longer does.
  void set_hidden(SplitId s, bool hidden);

 private:
  const Hierarchy* hierarchy_;
  bool attributes_;
  bool two_sided_;
  const ObjectView* view_ = nullptr;
  const RefineOptions* options_ = nullptr;
  StarVisibility star_;
  ZeroedArray<std::uint8_t> shares_;  // per split: 0 = not known, else 1 + share * 254
  std::vector<SplitId> known_;        // splits to forget when the next view begins
  std::vector<SplitId> unknown_;      // scratch, like the next one
  std::vector<StarView> stars_;
};

}  // namespace occlod
