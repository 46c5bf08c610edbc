// Which nodes are refined, drawn and culled in a frame, and the rules of a graph in which nodes have several parents.
// For one parent these do nothing.
#pragma once

#include <cstdint>

#include "hlod/draw/distance_queue.h"
#include "hlod/draw/draw_recorder.h"
#include "hlod/draw/frame_scene.h"

namespace occlod::hlod {

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
  void stop_within(NodeRef n, double most_error);
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
