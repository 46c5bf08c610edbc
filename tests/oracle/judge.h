// Backends before rays: the same bounds in the same random views for all of them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "oracle/random_view.h"

namespace occlod::test {

struct JudgedBound {
  std::string name;           // for messages: how to find it again
  bool must_show = false;     // whatever the tolerance: see RayOracle::certainly_visible
  bool hidden = false;        // no ray sees any of it, at the centres of its pixels
  bool seen_between = false;  // hidden, but a ray beside the centres, through a point of it, is not blocked
  std::vector<bool> shown;    // by backend: its answer
};

// One backend's answers.
struct Tally {
  std::vector<std::string> wrong;  // hidden although they must show
  int must_show = 0;
  int hidden = 0;        // as rays say
  int found = 0;         // of those, answered hidden
  int seen_between = 0;  // of those found
};

// Asks each backend about `bounds` bounds in each of `views` views, in portions of 25 that are answered together.
[[nodiscard]] std::vector<JudgedBound> judge(SceneKind scene, std::span<const std::unique_ptr<Visibility>> backends,
                                             int views, int bounds);
[[nodiscard]] Tally tally(std::span<const JudgedBound> judged, std::size_t backend);

}  // namespace occlod::test
