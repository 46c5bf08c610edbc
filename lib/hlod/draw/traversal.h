// Traverses the hierarchies of a frame, and keeps its queries in the order in which they were made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hlod/draw/front.h"
#include "hlod/draw/policy.h"

namespace occlod::hlod {

// Names a node to query.
struct AskedNode {
  NodeRef ref;
  double pixels = 0.0;  // number of pixels that its box covers on an empty screen
};

struct AnsweredNode {
  NodeRef ref;
  double pixels = 0.0;
  std::uint32_t visible = 0;  // pixels
  bool was_asked = true;      // false when the query did not pay off: the node counts as visible
};

class Questions {
 public:
  // The references must outlive the frame.
  void begin_frame(const FrameScene& scene, Policy& policy, RenderDevice& device, FrameStats& stats);

  // Makes a query now or later, as the policy says. `was_visible` tells that nothing waits for the answer.
  void ask(const AskedNode& n, bool was_visible);
  // Returns whether next() should be called now. `idle` tells that there is nothing else to do.
  [[nodiscard]] bool may_look(bool idle);
  // Waits for the answer to the oldest query and returns it. A group that is visible is first queried node by node.
  [[nodiscard]] AnsweredNode next();
  // Makes a deferred query when nothing else is left to do. Returns whether there was any.
  bool ask_waiting();

 private:
  struct Question {
    AskedNode node;
    QueryId query = 0;
    std::uint32_t visible = 0;  // pixels, if is_known
    bool is_known = false;
    bool was_asked = true;
    std::uint32_t group = 1;  // number of nodes, from this one on, that share the query
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
  std::vector<Question> asked_;  // in this frame, answered ones included
  std::size_t settled_ = 0;      // number of entries of asked_ that are settled
  std::vector<AskedNode> kept_;  // for the next round; with `late` or groups, formerly visible nodes, for idle moments
  std::size_t kept_asked_ = 0;   // number of entries of kept_ that were queried
  DistanceQueue urgent_;         // with `late`: nodes that were not visible, for when there is nothing else to do
  std::vector<NodeRef> hidden_;  // with groups: nodes that were not visible
  std::vector<BoxRef> boxes_;    // of the query that is being made
};

// Keeps memory from frame to frame.
struct TraversalMemory {
  DistanceQueue reached;
  CutCache cuts;
  Questions questions;
};

// Runs the loop that strategies share, with one queue of nodes by distance and one of queries in order (Bittner and
// others 2004; Charalambos 2006, sec. 2.2.1; Charalambos and others 2007, fig. 2).
class Traversal {
 public:
  // The references must outlive the traversal. `scene` and `device` have begun their frame.
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
