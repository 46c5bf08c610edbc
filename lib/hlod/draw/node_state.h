// What traversal knows of a node, in this frame and from the last.
#pragma once

#include <cstdint>

#include "occlod/hlod/hlod.h"

namespace occlod::hlod {

// A node of one of the objects.
struct NodeRef {
  std::uint32_t object = 0;
  NodeId node = 0;
};

enum class Status : std::uint8_t {
  absent,          // no parent has been refined so far
  undecided,       // reached: in the queue, or asked about
  held,            // wants to be refined, or refined within, but a parent is undecided
  refined,         // replaced by its children
  stopped,         // drawn where its parents are refined
  culled,          // outside the frustum, or hidden
  absent_stopped,  // never reached, since a coarser node is drawn
  absent_culled,   // never reached, since all coarser nodes are culled
};

// What is left of the frame before.
struct LastFrame {
  bool visited = false;  // reached, and inside the frustum
  bool visible = false;  // of those, it or a node below it was seen
  bool refined = false;  // of those, not stopped
  bool asked = false;    // reached, and asked about
};

struct NodeState {
  std::uint32_t frame = 0;        // that the fields below are of; 0: none
  std::uint32_t floor_frame = 0;  // in which bias_floor was set
  float bias = 1.0F;              // of the last answer; 1 again where the last frame did not visit the node
  float bias_floor = 0.0F;        // the least bias that the frame after floor_frame reckons with
  NodeId first_held = no_id;      // of the nodes that are held until this one is decided
  NodeId next_held = no_id;       // of those held for the same node
  float drawn_bias = 1.0F;        // that the node is drawn with, or will be when it is not held any more
  Status status = Status::absent;
  bool visited : 1 = false;
  bool visible : 1 = false;
  bool asked : 1 = false;
  bool denied : 1 = false;        // wanted to be refined, and a parent was drawn
  bool floored : 1 = false;       // it would have stopped without its bias_floor
  bool gone : 1 = false;          // found hidden after it was refined, or all its parents are gone or culled
  bool held_to_stop : 1 = false;  // held, and to be refined within
  bool cut : 1 = false;           // drawn refined within
  bool delayed : 1 = false;       // drawn only when its answer came
  bool hidden : 1 = false;        // so it was answered
  bool wasted : 1 = false;        // answered visible, and nothing was decided by it
  bool answered : 1 = false;      // the answer was read
  bool last_visited : 1 = false;
  bool last_visible : 1 = false;
  bool last_refined : 1 = false;
  bool last_asked : 1 = false;
};
static_assert(sizeof(NodeState) <= 32);

[[nodiscard]] inline LastFrame last_frame(const NodeState& state, std::uint32_t frame) noexcept {
  if (state.frame == frame) return {state.last_visited, state.last_visible, state.last_refined, state.last_asked};
  if (state.frame + 1 != frame || !state.visited) return {};
  return {true, state.visible, state.status == Status::refined, state.asked};
}

// Before the fields of this frame are used.
inline void enter_frame(NodeState& state, std::uint32_t frame) noexcept {
  if (state.frame == frame) return;
  const LastFrame last = last_frame(state, frame);
  if (!last.visited) state.bias = 1.0F;
  state.last_visited = last.visited;
  state.last_visible = last.visible;
  state.last_refined = last.refined;
  state.last_asked = last.asked;
  state.visited = state.visible = state.asked = state.denied = state.floored = state.gone = false;
  state.held_to_stop = state.cut = false;
  state.delayed = state.hidden = state.wasted = state.answered = false;
  state.first_held = state.next_held = no_id;
  state.status = Status::absent;
  state.frame = frame;
}

}  // namespace occlod::hlod
