// What tells strategies apart.
#pragma once

#include <memory>

#include "occlod/traverse/traverser.h"
#include "traverse/distance_queue.h"
#include "traverse/frame_scene.h"

namespace occlod::hlod {

// What to do about a node that has just been reached.
enum class Action {
  refine,  // by its children, without asking
  stop,    // ask, and draw it at once
  delay,   // ask, and decide when the answer comes
};

class Policy {
 public:
  Policy() = default;
  Policy(const Policy&) = delete;
  Policy& operator=(const Policy&) = delete;
  virtual ~Policy() = default;

  // n is inside the frustum.
  [[nodiscard]] virtual Action predict(FrameScene& scene, const ReachedNode& n) const = 0;
  // Whether errors are compared by what is visible of nodes.
  [[nodiscard]] virtual bool biased() const noexcept { return true; }
  // Otherwise everything inside the frustum counts as visible.
  [[nodiscard]] virtual bool asks() const noexcept { return true; }
  // For each answer, before anything else is done.
  [[nodiscard]] virtual bool waits() const noexcept { return false; }
};

// One file each.
[[nodiscard]] std::unique_ptr<Policy> make_frustum_policy();
[[nodiscard]] std::unique_ptr<Policy> make_waiting_policy(bool biased);
[[nodiscard]] std::unique_ptr<Policy> make_boolean_policy();
[[nodiscard]] std::unique_ptr<Policy> make_queue_place_policy();
[[nodiscard]] std::unique_ptr<Policy> make_coherent_policy();

// For `ideal` that of the pass by which it knows what to draw: `sw_b`.
[[nodiscard]] std::unique_ptr<Policy> make_policy(Strategy strategy);

}  // namespace occlod::hlod
