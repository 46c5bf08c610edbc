// Makes draws on a device and writes them down.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hlod/draw/frame_scene.h"
#include "occlod/build_hlod.h"
#include "occlod/traverser.h"

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
  bool draw_cut(NodeRef n, bool first, double max_error);
  // The same over a draw that was to have `drawn_error`, if it is finer.
  bool draw_finer_cut(NodeRef n, double max_error, double drawn_error);

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

// Which nodes are refined, drawn and culled in a frame, and the rules of a graph in which nodes have several parents.
// For one parent these do nothing.

// Whether a node may be refined.
enum class Permission {
  granted,  // every parent is refined or culled
  pending,  // a parent is undecided
  denied,   // a parent is drawn, so the node must not be replaced
};

class Front {
 public:
  // All outlive the front. Empties the queue.
  Front(FrameScene& scene, DistanceQueue& queue, DrawRecorder& draws);

  void reach_roots();
  // How many nodes have been reached so far.
  [[nodiscard]] std::uint32_t reached() const noexcept { return reached_; }
  [[nodiscard]] Permission may_refine(NodeRef n);
  // Replaces a node by its children: reaches those that are new, draws what they were not allowed to draw so far.
  void refine(NodeRef n);
  // Puts a node aside until a parent that is undecided is decided; then it is in the queue again.
  void hold(NodeRef n);
  // Draws what of the node its parents allow.
  void stop(NodeRef n);
  // The same of a node that may be refined: refined within, so that its error is at most this.
  void stop_within(NodeRef n, double max_error);
  void cull(NodeRef n);
  // A node that has been refined is hidden after all: nodes below it that are reached by nothing else are gone.
  void hide(NodeRef n);
  // The node, and all that it is reached by, has been seen in this frame.
  void see(NodeRef n);
  // A node wants to be refined and may not: lets those that are in its way be refined in the next frame.
  void raise_floors(NodeRef n);
  // Renews what refined parents needed for that.
  void keep_floors(NodeRef n);

 private:
  void reach(NodeRef n);
  void requeue_held(NodeState& state, std::uint32_t object);
  [[nodiscard]] bool is_gone(NodeRef n) const;
  Status resolve(NodeRef n);
  template <typename Visit>
  void for_each_parent(NodeRef n, const Visit& visit) const;

  FrameScene& scene_;
  DistanceQueue& queue_;
  DrawRecorder& draws_;
  std::uint32_t reached_ = 0;
  NodeRef undecided_;  // what resolve() found last
};

}  // namespace occlod::hlod
