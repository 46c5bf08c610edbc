// What is likely to be needed soon of HLODs whose meshes come and go.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "occlod/traverse/traverser.h"
#include "hlod/draw/object_frame.h"

namespace occlod::hlod {

// The view after so many more frames like the one that led from `before` to `now`: the eye goes on along a line, the
// line of sight turns on. Nothing when the camera stands still, or would end up where it makes no image.
[[nodiscard]] std::optional<View> view_ahead(const Camera& before, const View& now, int frames);

class Prefetcher {
 public:
  // Tells the stores of these objects, all of which have begun a frame, what it may be: first what is missing to draw
  // the objects from `ahead`, if given, without regard to occlusion; then the siblings of what `frame` has drawn.
  // O(nodes drawn, and inside that frustum), but at most some thousand of the latter.
  void run(std::span<const PlacedHlod> objects, const Frame& frame, const std::optional<View>& ahead,
           const TraverseOptions& options);

 private:
  void look_ahead(const PlacedHlod& object, const View& ahead, const TraverseOptions& options);

  std::vector<NodeId> reached_;  // scratch: in turn, each once
  std::vector<bool> marks_;      // by node, whether it is among them; all false between calls
};

}  // namespace occlod::hlod
