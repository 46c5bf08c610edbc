// Measures how far the picture of a frame of an HLOD is from the input's.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "front_mesh.h"
#include "input_normals.h"
#include "occlod/compare.h"
#include "occlod/device.h"
#include "occlod/picture.h"
#include "occlod/traverser.h"
#include "occlod/view.h"

namespace occlod::tool {

struct HlodDistance {
  PictureDistance to_full;  // the input
  // This is the distance to what vfc draws with the same tolerance, without occlusion and bias, like the picture of
  // `bool`. At tolerance 0 it is the distance to the input.
  PictureDistance to_unculled;
  // Counts pixels by count_lost_pixels() against the input, within the tolerance: what occlusion hides wrongly, and
  // what simplification loses. That of vfc, which hides nothing, is the latter alone.
  std::size_t wrongly_hidden_px = 0;
  // Counts pixels by count_crack_pixels() against the input, within four times the tolerance, since errors of nodes are
  // no bounds. With a bias errors are larger, and a counted pixel need not be a gap.
  std::size_t crack_px = 0;
  Popping popping;                // since the previous frame, of what both views show
  double depth_complexity = 0.0;  // fragments of the input inside the frustum per covered pixel
};

// Draws every picture itself with our own rasteriser, without what is beyond the far plane: there nodes are culled.
// Pictures have the input's smooth normals and no outlines. The input is all its triangles, whatever the boxes of nodes
// say of them. Reuses its memory from frame to frame.
class HlodReference {
 public:
  // The HLODs and what `placed` points to must outlive it. `options` and `trial` (may be null) are those of the frames
  // to compare.
  HlodReference(std::span<const hlod::PlacedHlod> placed, const hlod::TraverseOptions& options,
                const hlod::Trial* trial);

  // Draws the pictures to compare frames of this view with. `last` is the view of the previous frame. The view must
  // outlive the comparisons. O(triangles of the input + pixels).
  void set_view(const View& view, const View& last);
  // Compares a frame of that view. `before` is what the previous frame drew. O(triangles drawn + pixels * tolerance).
  [[nodiscard]] HlodDistance compare(const Front& front, const Front& before);

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
  Front input_;
  InputNormals normals_;
  const View* view_ = nullptr;
  Picture full_, plain_, frame_;
  double depth_complexity_ = 0.0;
  FrontMesh before_mesh_;
  ItemBuffer before_items_;
  std::vector<bool> shown_before_;  // per pixel, whether the previous view also showed that part of the input
};

}  // namespace occlod::tool
