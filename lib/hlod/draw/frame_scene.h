// Areas of what points surround in an image.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "hlod/draw/box_proxy.h"
#include "hlod/draw/trial.h"
#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "occlod/node_store.h"
#include "occlod/traverser.h"
#include "occlod/view.h"

namespace occlod::hlod {

// Pixels of the part of the convex hull of at most 8 points that lies in [0, size.x] x [0, size.y].
[[nodiscard]] double hull_area_inside(std::span<const glm::dvec2> points, const glm::dvec2& size);

// Everything visible counts in full: plain screen-space error.
[[nodiscard]] constexpr double no_bias(double mu) noexcept { return mu > 0.0 ? 1.0 : 0.0; }

// One object in one view: what traversal computes of a node from its bounds.

class ObjectFrame {
 public:
  ObjectFrame(const View& view, const PlacedHlod& placed, const Trial& trial = {});

  [[nodiscard]] double error_px(const Node& node) const;
  // Refined within as far as possible.
  [[nodiscard]] double min_error_px(const Node& node) const;
  // Object units; of so many pixels.
  [[nodiscard]] double error_limit(const Node& node, double pixels) const;
  // By which nodes are taken in turn: world units from the eye, or from the eye plane where rays are parallel.
  [[nodiscard]] double distance(const Box& box) const;
  // False only when no point of the box is inside the frustum.
  [[nodiscard]] bool may_be_inside(const Box& box) const;
  // Share of the image that a box covers, whether inside it or not: box_coverage().
  [[nodiscard]] double coverage(const Box& box) const;
  // Of the image.
  [[nodiscard]] double pixels() const noexcept { return static_cast<double>(screen_.width) * screen_.height; }
  // Pixels that the node's box covers on an empty screen, as `alpha` counts them. Nothing where devices would not draw
  // it but count all pixels, as around the eye: such nodes are visible.
  [[nodiscard]] std::optional<double> box_pixels(const Node& node) const;

 private:
  [[nodiscard]] std::optional<double> outline_pixels(const Box& box) const;
  [[nodiscard]] double cube_pixels(const Node& node) const;

  ObjectView view_;
  ScreenScale scale_;
  Screen screen_;
  ProxySpace proxy_space_;
  glm::dvec4 depth_;     // dot product with (p, 1): distance from the eye plane, world units
  double volume_scale_;  // cubic world units per cubic object unit
  Metric metric_;
  Alpha alpha_;
};

// What traversal knows of a node, in this frame and from the last.

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

// Nodes that have been reached, the nearest first.

struct ReachedNode {
  double distance = 0.0;  // as ObjectFrame::distance()
  NodeRef ref;
  std::uint32_t place = 0;  // how many nodes were reached before it in this frame
};

// Ties by object, then by node, so coarse nodes first.
class DistanceQueue {
 public:
  void clear() noexcept { heap_.clear(); }
  [[nodiscard]] bool empty() const noexcept { return heap_.empty(); }
  void push(const ReachedNode& node) {
    heap_.push_back(node);
    std::push_heap(heap_.begin(), heap_.end(), comes_later);
  }
  [[nodiscard]] ReachedNode pop() {
    std::pop_heap(heap_.begin(), heap_.end(), comes_later);
    const ReachedNode node = heap_.back();
    heap_.pop_back();
    return node;
  }

 private:
  static bool comes_later(const ReachedNode& a, const ReachedNode& b) noexcept {
    if (a.distance != b.distance) return a.distance > b.distance;
    if (a.ref.object != b.ref.object) return a.ref.object > b.ref.object;
    return a.ref.node > b.ref.node;
  }

  std::vector<ReachedNode> heap_;
};

// What a frame is traversed with: the objects in its view, and their nodes' states.

class FrameScene {
 public:
  explicit FrameScene(std::span<const PlacedHlod> objects);

  // Forgets all that is known of nodes.
  void forget();
  // biased: errors are compared by what is visible of nodes, where the trial says so too.
  void begin_frame(const View& view, std::span<const PlacedHlod> objects, const TraverseOptions& options,
                   const Trial& trial, bool biased);

  // Nodes that were reached in this frame.
  void end_frame(std::uint32_t reached) noexcept { reached_last_ = reached; }
  // Nodes that were reached in the last frame; 0 before the first.
  [[nodiscard]] std::uint32_t reached_last() const noexcept { return reached_last_; }

  [[nodiscard]] std::uint32_t frame() const noexcept { return frame_; }
  [[nodiscard]] const TraverseOptions& options() const noexcept { return options_; }
  [[nodiscard]] const Trial& trial() const noexcept { return trial_; }
  [[nodiscard]] std::uint32_t object_count() const noexcept { return static_cast<std::uint32_t>(hlods_.size()); }
  [[nodiscard]] const Hlod& hlod(NodeRef n) const noexcept { return *hlods_[n.object]; }
  [[nodiscard]] const Node& node(NodeRef n) const noexcept { return hlod(n).node(n.node); }
  [[nodiscard]] NodeState& state(NodeRef n) noexcept { return states_[n.object][n.node]; }
  [[nodiscard]] const NodeState& state(NodeRef n) const noexcept { return states_[n.object][n.node]; }
  [[nodiscard]] LastFrame last(NodeRef n) const noexcept { return last_frame(state(n), frame_); }
  [[nodiscard]] const ObjectFrame& view_of(NodeRef n) const noexcept { return frames_[n.object]; }

  // As the node is.
  [[nodiscard]] double error_px(NodeRef n) const { return view_of(n).error_px(node(n)); }
  // Without replacing it by its children.
  [[nodiscard]] double min_error_px(NodeRef n) const {
    return may_be_cut(n) ? view_of(n).min_error_px(node(n)) : error_px(n);
  }
  // Of a node of which this share is visible.
  [[nodiscard]] double bias(double mu) const noexcept { return biased_ ? options_.bias(mu) : no_bias(mu); }
  // Whether the node is as fine as it should be with this bias, refined within if need be. With a tolerance of 0 only
  // level 0 is, whatever the error.
  [[nodiscard]] bool is_within_tolerance(NodeRef n, double bias) const;
  // Whether the node cannot be refined in this frame: the mesh of a child that may be inside the frustum is not there.
  [[nodiscard]] bool lacks_children(NodeRef n) const;
  // Whether the node is as fine as it should be or as it can be: what is not there is as if there was nothing below.
  [[nodiscard]] bool is_fine(NodeRef n, double bias) const { return is_within_tolerance(n, bias) || lacks_children(n); }
  // The same, but for what finer nodes needed of it in the last frame (raise_floor()). Notes when that decides.
  [[nodiscard]] bool stops(NodeRef n, double bias);
  // Whether a node that is fine enough with this bias is so only when it is refined within.
  [[nodiscard]] bool needs_cut(NodeRef n, double bias) const {
    return may_be_cut(n) && bias * error_px(n) > options_.tolerance_px && is_fine(n, bias);
  }
  // To which error, object units. bias > 0.
  [[nodiscard]] double cut_error(NodeRef n, double bias) const {
    return view_of(n).error_limit(node(n), options_.tolerance_px / bias);
  }
  // With so many of its splits applied.
  [[nodiscard]] double cut_error_px(NodeRef n, std::uint32_t splits) const {
    const double error = error_of_splits(hlod(n), n.node, splits);
    return std::max(error / view_of(n).error_limit(node(n), 1.0), min_error_px(n));
  }
  // The mesh of the node is used in this frame, if it is there.
  void need(NodeRef n) const;
  // Whether the children that may be inside the frustum are there, read if need be.
  [[nodiscard]] bool fetch_children(NodeRef n);
  // The node is drawn with this bias because they are not.
  void want_children(NodeRef n, double bias);
  // Lets the node be refined in the next frame, since a finer one cannot be drawn without. Only its bias is against it.
  void raise_floor(NodeRef n);

 private:
  [[nodiscard]] bool may_be_cut(NodeRef n) const {
    return options_.within && options_.tolerance_px > 0.0 && hlod(n).has_within(n.node);
  }

  void find_children_inside(NodeRef n);

  std::vector<const Hlod*> hlods_;
  std::vector<NodeStore*> stores_;              // by object; null where all meshes are there
  std::vector<NodeId> children_inside_;         // scratch
  std::vector<std::vector<NodeState>> states_;  // by object, then by node
  std::vector<ObjectFrame> frames_;             // by object
  TraverseOptions options_;
  Trial trial_;
  bool biased_ = false;
  std::uint32_t frame_ = 0;
  std::uint32_t reached_last_ = 0;
};

}  // namespace occlod::hlod
