// Makes draws on a device and writes them down.
#pragma once

#include <cstddef>
#include <cstdint>

#include "occlod/hlod/within.h"
#include "occlod/traverse/traverser.h"
#include "hlod/draw/frame_scene.h"

namespace occlod::hlod {

class DrawRecorder {
 public:
  // All outlive the recorder.
  DrawRecorder(const FrameScene& scene, RenderDevice& device, CutCache& cuts, Frame& frame)
      : scene_(scene), device_(device), cuts_(cuts), frame_(frame) {}

  // Draws the patches of node n for which is_drawn(parent) holds, if any. `first`: nothing of it has been drawn in this
  // frame before.
  template <typename IsDrawn>
  void draw(NodeRef n, bool first, const IsDrawn& is_drawn) {
    first_range_ = frame_.ranges.size();
    std::uint32_t place = 0;
    for (const Patch& patch : scene_.hlod(n).patches(n.node)) {
      if (is_drawn(patch.parent)) add(n, patch, place);
      ++place;
    }
    if (frame_.ranges.size() > first_range_) submit(n, first);
  }

  // Draws the node refined within, which is to have this error at most. False when that changes nothing of it.
  bool draw_cut(NodeRef n, bool first, double most_error);
  // The same over a draw that was to have `drawn_error`, if it is finer.
  bool draw_finer_cut(NodeRef n, double most_error, double drawn_error);

 private:
  void submit_cut(NodeRef n, bool first, const NodeCut& cut);
  void add(NodeRef n, const Patch& patch, std::uint32_t place);
  void submit(NodeRef n, bool first);
  [[nodiscard]] float morph(NodeRef n, NodeId parent) const;

  const FrameScene& scene_;
  RenderDevice& device_;
  CutCache& cuts_;
  Frame& frame_;
  std::size_t first_range_ = 0;  // of the draw in the making
};

}  // namespace occlod::hlod
