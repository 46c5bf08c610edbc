// Declares the decisions in which strategies differ.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "hlod/draw/frame_scene.h"
#include "occlod/traverser.h"

namespace occlod::hlod {

// Names what to do about a node that has just been reached.
enum class Action {
  refine,   // replace by its children, without a query
  stop,     // query, and draw at once
  delay,    // query, and decide when the answer comes
  draw,     // draw at once, without a query
  descend,  // query, and refine at once; if the node turns out hidden, pending work below it is dropped
  drop,     // query, and treat as hidden
};

// Names when and how nodes are queried by their boxes.
enum class Asking {
  singly,     // each node in its turn
  late,       // each when no other node is left; nodes that were visible, while waiting for other answers
  by_rounds,  // together in one batch when no other node is left
  by_groups,  // hidden nodes together (group()), visible ones while waiting for other answers
};

class Policy {
 public:
  Policy() = default;
  Policy(const Policy&) = delete;
  Policy& operator=(const Policy&) = delete;
  virtual ~Policy() = default;

  // Is called first in each frame.
  virtual void begin_frame(const FrameScene&) {}
  // Decides about n, which is inside the frustum.
  [[nodiscard]] virtual Action predict(FrameScene& scene, const ReachedNode& n) = 0;
  // Returns the bias with which a node that is to stop is drawn before its answer comes.
  [[nodiscard]] virtual double bias(const FrameScene&, const ReachedNode&) const { return 1.0; }
  // Is called when n has been stopped.
  virtual void note_drawn(const FrameScene&, NodeRef) {}
  // Is called when the query about n is answered.
  virtual void note_answer(const FrameScene&, NodeRef, bool /*visible*/) {}
  // Is called with Asking::by_rounds when `asked` nodes wait for a query. Returns whether the queries pay off;
  // otherwise the nodes count as visible.
  virtual bool end_round(const FrameScene&, std::size_t /*asked*/) { return true; }
  // Is called after the last command of a frame.
  virtual void end_frame(const FrameScene&) {}

  // Returns whether errors are multiplied by a bias for the visible share of nodes.
  [[nodiscard]] virtual bool biased() const noexcept { return true; }
  // Returns whether each answer is waited for before anything else is done.
  [[nodiscard]] virtual bool waits() const noexcept { return false; }
  [[nodiscard]] virtual Asking asking() const noexcept { return Asking::singly; }
  // Returns how many queries after a query its answer is taken to be available.
  [[nodiscard]] virtual std::size_t max_asked() const noexcept { return std::numeric_limits<std::size_t>::max(); }
  // Returns whether answers affect this frame; otherwise they are for the next.
  [[nodiscard]] virtual bool answers_decide() const noexcept { return true; }
  // Returns whether answers are waited for when nothing else is to do; otherwise late ones are dropped.
  [[nodiscard]] virtual bool waits_for_late_answers() const noexcept { return answers_decide(); }
  // Appends the boxes by which n is queried. They contain everything that is drawn in its place.
  virtual void add_boxes(const FrameScene& scene, NodeRef n, std::vector<BoxRef>& boxes) {
    boxes.push_back({n.object, scene.node(n).box});
  }
  // Returns the policy to traverse with first, on another device, to learn what is hidden; null if none.
  [[nodiscard]] virtual Policy* oracle() noexcept { return nullptr; }
  // With Asking::by_groups: given the hidden nodes that wait for a query, at least one, moves those to query together
  // to the front. Returns their number.
  [[nodiscard]] virtual std::size_t group(const FrameScene&, std::span<NodeRef> hidden) {
    return std::min<std::size_t>(hidden.size(), 1);
  }
};

// Returns what Coh(B) does about a node inside the frustum (Charalambos and others 2007, fig. 3).
[[nodiscard]] Action predict_coherent(FrameScene& scene, NodeRef n, Coherence coherence);

// Returns the policy of a strategy other than `automatic`, which uses one of the others. bench/papers has rivals.
[[nodiscard]] std::unique_ptr<Policy> make_policy(Strategy strategy);
[[nodiscard]] std::unique_ptr<Policy> make_near_optimal_policy();
[[nodiscard]] std::unique_ptr<Policy> make_batch_policy();

}  // namespace occlod::hlod
