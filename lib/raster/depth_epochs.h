// By which powers of two nearness is multiplied, so that one picture can be drawn over another without clearing it.
#pragma once

#include <optional>
#include <span>

#include "occlod/view/view.h"

namespace occlod {

// Whatever is left of earlier pictures is then smaller than anything that the view shows: as if nothing were there. A
// power of two changes no bit of a number but its exponent, so answers are those of pictures that have been cleared.
class DepthEpochs {
 public:
  // Begins a picture of a view of objects; false when it must be cleared first.
  [[nodiscard]] bool begin(const View& view, std::span<const ObjectView> objects);

  // Nearness is multiplied by this, and object_to_clip divided by it, which comes to the same.
  [[nodiscard]] float scale() const noexcept { return scale_; }
  // Less is farther than anything in the view, times scale().
  [[nodiscard]] float least() const noexcept { return least_; }

 private:
  struct Range {
    double near, far;
    int width, height;
    friend bool operator==(const Range&, const Range&) = default;
  };
  std::optional<Range> range_;  // of the pictures since the last that was cleared
  int exponent_ = 0;
  float scale_ = 1.0F, least_ = 0.0F;
};

}  // namespace occlod
