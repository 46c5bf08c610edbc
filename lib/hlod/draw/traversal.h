// What has been asked about nodes in a frame, in the order in which it was asked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hlod/draw/front.h"
#include "hlod/draw/policy.h"

namespace occlod::hlod {

// A node to ask about.
struct AskedNode {
  NodeRef ref;
  double pixels = 0.0;  // that its box covers on an empty screen
};

struct AnsweredNode {
  NodeRef ref;
  double pixels = 0.0;
  std::uint32_t visible = 0;  // pixels
  bool was_asked = true;      // otherwise it did not pay, and the node counts as visible
};

class Questions {
 public:
  // All outlive the frame.
  void begin_frame(const FrameScene& scene, Policy& policy, RenderDevice& device, FrameStats& stats);

  // Asks, or keeps for later as the policy says. was_visible: the answer is not waited for.
  void ask(const AskedNode& n, bool was_visible);
  // Whether next() is to be called now. idle: there is nothing else to do.
  [[nodiscard]] bool may_look(bool idle);
  // The answer to the oldest question, waited for. A group that is visible has been asked about node by node.
  [[nodiscard]] AnsweredNode next();
  // When nothing else is left to do: asks what was kept. Whether there was anything.
  bool ask_waiting();

 private:
  struct Question {
    AskedNode node;
    QueryId query = 0;
    std::uint32_t visible = 0;  // pixels, if known
    bool is_known = false;
    bool was_asked = true;
    std::uint32_t group = 1;  // so many nodes, from this one on, share the query
  };
  [[nodiscard]] AskedNode with_pixels(NodeRef n) const;
  void ask_singly(const AskedNode& n);
  void ask_round();
  void ask_groups();
  bool ask_kept(bool is_waiting);
  void settle_group();
  [[nodiscard]] bool is_gone(const Question& question) const;
  [[nodiscard]] bool is_answered(const Question& question);

  const FrameScene* scene_ = nullptr;
  Policy* policy_ = nullptr;
  RenderDevice* device_ = nullptr;
  FrameStats* stats_ = nullptr;
  std::vector<Question> asked_;  // of this frame, answered ones included
  std::size_t settled_ = 0;      // of asked_
  std::vector<AskedNode> kept_;  // for the next round; late or with groups, nodes that were visible, for idle moments
  std::size_t kept_asked_ = 0;   // of these
  DistanceQueue urgent_;         // late: nodes that were not visible, for as soon as there is nothing else to do
  std::vector<NodeRef> hidden_;  // with groups, the same
  std::vector<BoxRef> boxes_;    // of a query in the making
};

// The loop that strategies share: one queue of nodes by distance, one of questions in the order in which they were
// asked (Bittner and others 2004; Charalambos 2006, sec. 2.2.1; Charalambos and others 2007, fig. 2).

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
