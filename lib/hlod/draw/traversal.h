// The loop that strategies share: one queue of nodes by distance, one of questions in the order in which they were
// asked (Bittner and others 2004; Charalambos 2006, sec. 2.2.1; Charalambos and others 2007, fig. 2).
#pragma once

#include <cstddef>
#include <vector>

#include "hlod/draw/front.h"
#include "hlod/draw/policy.h"
#include "hlod/draw/questions.h"

namespace occlod::hlod {

// Memory that is kept from frame to frame.
struct TraversalMemory {
  DistanceQueue reached;
  CutCache cuts;
  Questions questions;
};

class Traversal {
 public:
  // All outlive the traversal. `scene` has begun its frame, and so has the device.
  Traversal(FrameScene& scene, Policy& policy, RenderDevice& device, TraversalMemory& memory, Frame& frame);

  void run();

 private:
  void visit(const ReachedNode& reached);
  void predict(const ReachedNode& reached);
  void act(const ReachedNode& reached, Action action);
  void ask(NodeRef n, double pixels, bool was_visible);
  void settle_next();
  void settle_hidden(NodeRef n);
  void settle_unasked(NodeRef n);
  void see_unasked(NodeRef n);
  void stop(NodeRef n, double bias);
  void draw_whole(NodeRef n, double bias);
  void settle(NodeRef n, double mu);
  void settle_held(NodeRef n, double bias);
  void settle_drawn(NodeRef n, bool is_fine, double bias);
  bool draw_finer(NodeRef n, double bias);
  [[nodiscard]] bool is_drawable(NodeRef n) const;
  void want_refined(NodeRef n);
  void draw_unrefined(NodeRef n);
  void note_denied(NodeRef n);
  void note_waiting(NodeRef n, double bias);
  void note_delayed(NodeRef n);
  void note_wasted(NodeRef n);

  FrameScene& scene_;
  Policy& policy_;
  RenderDevice& device_;
  TraversalMemory& memory_;
  FrameStats& stats_;
  std::vector<NodeAnswer>& asked_;
  DrawRecorder draws_;
  Front front_;
};

}  // namespace occlod::hlod
