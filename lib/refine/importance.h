// What applying a split is worth to one eye, and what it costs in triangles that this eye does not see.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.h"
#include "occlod/refiner.h"
#include "refine/screen_error.h"
#include "refine/star_visibility.h"

namespace occlod {

// Faces that are seen under a smaller cosine count as if it were this: the nearly edge-on ones are narrower than a
// pixel.
inline constexpr float min_cosine = 0.2F;

// Of one object. Reuses its memory from view to view.
class Importance {
 public:
  explicit Importance(const RefineObject& object);

  // Starts a view. All three outlive it.
  void begin(const ObjectView& view, const RefineOptions& options);

  struct Value {
    float visible_share = 0.0F;  // of the split's faces; 0: it changes nothing that is seen
    float priority = 0.0F;       // its error in pixels, weighed by how its faces are seen
    ScreenError error;           // unweighted
  };
  // By the split's own star.
  [[nodiscard]] Value of(SplitId s) {
    Value value;
    find({&s, 1}, {&value, 1});
    return value;
  }
  // The same of many, which costs less than one by one; `values` has as many places.
  void find(std::span<const SplitId> splits, std::span<Value> values);
  // The same for a star that has been looked at, of a split with these errors.
  [[nodiscard]] Value of(const StarView& star, const SplitErrors& errors) const;
  // The share of a star that has been looked at is known from now on.
  void remember(SplitId s, float visible_share);

  // closure[0] is a split, the others are what it forces. The factor by which its priority sinks for stars among
  // these that are not seen, in (0, 1].
  [[nodiscard]] float forced_weight(std::span<const SplitId> closure);
  // Share of the star of s that is seen; from memory if it has been asked for in this view.
  [[nodiscard]] float visible_share(SplitId s);
  [[nodiscard]] bool knows_share(SplitId s) const noexcept { return shares_[s] != 0; }
  // Looks at all of these that are not known yet. Each may come several times.
  void find_shares(std::span<const SplitId> splits);
  // The occluder hides all of the star of s, or no longer does.
  void set_hidden(SplitId s, bool hidden);

 private:
  const Hierarchy* hierarchy_;
  bool attributes_;
  bool two_sided_;
  const ObjectView* view_ = nullptr;
  const RefineOptions* options_ = nullptr;
  StarVisibility star_;
  ZeroedArray<std::uint8_t> shares_;  // of each split: 0 = not known, else 1 + share * 254
  std::vector<SplitId> known_;        // to be forgotten when the next view begins
  std::vector<SplitId> unknown_;      // scratch, both
  std::vector<StarView> stars_;
};

}  // namespace occlod
