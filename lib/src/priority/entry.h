// Something that refinement may do next.
#pragma once

#include <array>
#include <cstdint>

#include "occlod/core/ids.h"
#include "priority/screen_error.h"

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
  std::uint32_t asked_occluder = 0;  // number of the occluder that it was last asked about against; 0 = never asked
  Kind kind = Kind::visit;
  bool weighed = false;                    // priority includes what the split forces
  bool is_hidden = false;                  // by the occluder asked_occluder
  bool children_weighed = false;           // of a node that is visited: the scales are known
  std::array<float, 2> child_scales_px{};  // of child_u and child_v, see Lookahead
};

}  // namespace occlod
