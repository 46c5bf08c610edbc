// How far the picture of a frame of an HLOD is from the truth.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "front_mesh.h"
#include "occlod/compare.h"
#include "occlod/device.h"
#include "occlod/picture.h"
#include "occlod/traverser.h"
#include "occlod/view.h"

namespace occlod::tool {

struct HlodDistance {
  PictureDistance to_full;  // the input
  // What vfc draws with the same tolerance: no occlusion and no bias, as the picture of `bool` is too.
  PictureDistance to_unculled;
  std::size_t wrongly_hidden_px = 0;  // pixels of that which the frame cannot explain within the errors of both
  // count_crack_pixels() against the input, within four times the tolerance: errors of nodes are no bounds. With a bias
  // errors are larger, and what is counted need not be a gap.
  std::size_t crack_px = 0;
  Popping popping;                // since the frame before, of what both views show
  double depth_complexity = 0.0;  // fragments of the input inside the frustum for each pixel that it covers
};

// Draws every picture itself, with our own rasteriser. Reuses its memory from frame to frame.
class HlodReference {
 public:
  // The HLODs and what `placed` points to outlive it. `options`, `trial` (null: none): of the frames that are compared.
  HlodReference(std::span<const hlod::PlacedHlod> placed, const hlod::TraverseOptions& options,
                const hlod::Trial* trial);

  // Draws what frames of this view are compared with. `last`: the view of the frame before. The view outlives
  // comparisons. O(triangles of the input inside the frustum + pixels).
  void set_view(const View& view, const View& last);
  // Compares a frame of that view. `before`: what the frame before has drawn. `largest_sse_px`: of the frame.
  // O(triangles drawn + pixels).
  [[nodiscard]] HlodDistance compare(const Front& front, const Front& before, double largest_sse_px);

 private:
  struct Picture {
    FrontMesh mesh;
    ItemBuffer items;
    Image image;
  };
  void draw(Picture& picture, const Front& front);

  std::span<const hlod::PlacedHlod> placed_;
  hlod::TraverseOptions options_;
  hlod::Traverser unculled_;
  hlod::SoftwareDevice device_;
  const View* view_ = nullptr;
  Picture full_, plain_, frame_;
  double plain_sse_px_ = 0.0;  // the largest that plain_ shows
  double depth_complexity_ = 0.0;
  FrontMesh before_mesh_;
  ItemBuffer before_items_;
  std::vector<bool> shown_before_;  // by pixel: whether the view before has shown that part of the input too
};

}  // namespace occlod::tool
