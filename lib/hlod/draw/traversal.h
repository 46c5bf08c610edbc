// The loop that strategies share: one queue of nodes by distance, one of questions in the order in which they were
// asked (Bittner and others 2004; Charalambos 2006, sec. 2.2.1; Charalambos and others 2007, fig. 2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hlod/draw/frame_scene.h"
#include "hlod/draw/policy.h"
#include "occlod/build_hlod.h"
#include "occlod/traverser.h"

namespace occlod::hlod {

// Makes draws on a device and writes them down.
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

// What has been asked about nodes in a frame, in the order in which it was asked.

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
