// Decides which nodes are refined, drawn and culled in a frame, and draws them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hlod/draw/frame_scene.h"
#include "occlod/build_hlod.h"
#include "occlod/traverser.h"

namespace occlod::hlod {

// Makes draws on a device and records them in the frame.
class DrawRecorder {
 public:
  // The references must outlive the recorder.
  DrawRecorder(const FrameScene& scene, RenderDevice& device, CutCache& cuts, Frame& frame)
      : scene_(scene), device_(device), cuts_(cuts), frame_(frame) {}

  // Draws the patches of node n for which is_drawn(parent) is true, if any. `first` tells that no patch of it was drawn
  // in this frame.
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

  // Draws the node refined within to an error of at most `max_error`, in object units. Returns false, and draws
  // nothing, when that would not change the node.
  bool draw_cut(NodeRef n, bool first, double max_error);
  // Draws the node over an earlier draw of it with `drawn_error`, if the new draw is finer.
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
  std::size_t first_range_ = 0;  // first range of the draw that is being made
};

// Tells whether a node may be refined.
enum class Permission {
  granted,  // every parent is refined or culled
  pending,  // a parent is undecided
  denied,   // a parent is drawn, so the node must not be replaced
};

// Decides by the rules for nodes with several parents. For a node with one parent they never intervene.
class Front {
 public:
  // The references must outlive the front. Empties the queue.
  Front(FrameScene& scene, DistanceQueue& queue, DrawRecorder& draws);

  void reach_roots();
  // Returns the number of nodes that have been reached in this frame.
  [[nodiscard]] std::uint32_t reached() const noexcept { return reached_; }
  [[nodiscard]] Permission may_refine(NodeRef n);
  // Replaces a node by its children: reaches new ones, and draws the patches of others that had to wait for this.
  void refine(NodeRef n);
  // Puts a node aside; it returns to the queue when its undecided parent is decided.
  void hold(NodeRef n);
  // Draws the patches of the node that its parents allow.
  void stop(NodeRef n);
  // Draws a node that may be refined, refined within so that its error is at most `max_error`, in object units.
  void stop_within(NodeRef n, double max_error);
  void cull(NodeRef n);
  // Marks a refined node as hidden after all, and the nodes below it that no other node reaches as gone.
  void hide(NodeRef n);
  // Marks the node, and all nodes through which it was reached, as visible in this frame.
  void see(NodeRef n);
  // Lets the drawn nodes that keep this node from being refined be refined in the next frame.
  void raise_floors(NodeRef n);
  // Renews the floors that let the parents of this node be refined.
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
  NodeRef undecided_;  // undecided node that resolve() found last
};

}  // namespace occlod::hlod
