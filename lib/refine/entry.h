// Something that refinement may do next.
#pragma once

#include <cstdint>

#include "occlod/core/ids.h"
#include "refine/screen_error.h"

namespace occlod {

struct Entry {
  enum class Kind : std::uint8_t {
    visit,  // look at a node: descend below it
    apply,  // apply the split itself
  };
  float priority = 0.0F;  // quadric screen error in pixels, weighted
  ScreenError error;      // unweighted
  SplitId split = no_id;
  std::uint32_t object = 0;
  std::uint32_t level = 0;           // of the split in the forest, 0 at roots
  std::uint32_t asked_occluder = 0;  // number of the occluder that did not hide it when asked last; 0 = never asked
  Kind kind = Kind::visit;
  bool weighed = false;     // priority includes what the split forces
  bool star_shows = false;  // that occluder does not hide the split's own star either
};

}  // namespace occlod
