// What tells strategies apart.
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

// What to do about a node that has just been reached.
enum class Action {
  refine,   // by its children, without asking
  stop,     // ask, and draw it at once
  delay,    // ask, and decide when the answer comes
  draw,     // at once, without asking
  descend,  // ask, and refine it at once; if it turns out hidden, what has not been done below it is left undone
  drop,     // ask, and take it for hidden
};

// How the boxes of nodes are asked about.
enum class Asking {
  singly,     // each when its node's turn comes
  late,       // each when no other node is left; those that were visible while something else is waited for
  by_rounds,  // together when no other node is left, in one batch
  by_groups,  // hidden ones together (group()), visible ones while something else is waited for
};

class Policy {
 public:
  Policy() = default;
  Policy(const Policy&) = delete;
  Policy& operator=(const Policy&) = delete;
  virtual ~Policy() = default;

  // Before anything else in a frame.
  virtual void begin_frame(const FrameScene&) {}
  // n is inside the frustum.
  [[nodiscard]] virtual Action predict(FrameScene& scene, const ReachedNode& n) = 0;
  // With which bias a node that is to stop is drawn before its answer comes.
  [[nodiscard]] virtual double bias(const FrameScene&, const ReachedNode&) const { return 1.0; }
  // n has been stopped.
  virtual void note_drawn(const FrameScene&, NodeRef) {}
  // What was asked about n.
  virtual void note_answer(const FrameScene&, NodeRef, bool /*visible*/) {}
  // With Asking::by_rounds: so many nodes wait to be asked about. Whether that pays; otherwise they are visible.
  virtual bool end_round(const FrameScene&, std::size_t /*asked*/) { return true; }
  // After the last command of a frame.
  virtual void end_frame(const FrameScene&) {}

  // Whether errors are compared by what is visible of nodes.
  [[nodiscard]] virtual bool biased() const noexcept { return true; }
  // For each answer, before anything else is done.
  [[nodiscard]] virtual bool waits() const noexcept { return false; }
  [[nodiscard]] virtual Asking asking() const noexcept { return Asking::singly; }
  // So many questions after one was asked, its answer is taken to be there.
  [[nodiscard]] virtual std::size_t max_asked() const noexcept { return std::numeric_limits<std::size_t>::max(); }
  // Otherwise answers are for the next frame.
  [[nodiscard]] virtual bool answers_decide() const noexcept { return true; }
  // When nothing else is to do. Otherwise those that are late are dropped.
  [[nodiscard]] virtual bool waits_for_late_answers() const noexcept { return answers_decide(); }
  // The boxes by which n is asked about. They hold all that is drawn in its place.
  virtual void add_boxes(const FrameScene& scene, NodeRef n, std::vector<BoxRef>& boxes) {
    boxes.push_back({n.object, scene.node(n).box});
  }
  // What has to be traversed before, on another device, to know what is hidden.
  [[nodiscard]] virtual Policy* oracle() noexcept { return nullptr; }
  // With Asking::by_groups: of hidden nodes that wait to be asked about, at least one, those to be asked about in one
  // query go to the front. Returns their number.
  [[nodiscard]] virtual std::size_t group(const FrameScene&, std::span<NodeRef> hidden) {
    return std::min<std::size_t>(hidden.size(), 1);
  }
};

// What Coh(B) does about a node that is inside the frustum (Charalambos and others 2007, fig. 3).
[[nodiscard]] Action predict_coherent(FrameScene& scene, NodeRef n, Coherence coherence);

// Those of users, but for `automatic`, which is one of the others. Rivals are in bench/papers.
[[nodiscard]] std::unique_ptr<Policy> make_policy(Strategy strategy);
[[nodiscard]] std::unique_ptr<Policy> make_near_optimal_policy();
[[nodiscard]] std::unique_ptr<Policy> make_batch_policy();

}  // namespace occlod::hlod
