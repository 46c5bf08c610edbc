// Holds what traversal computes from bounds in one view, and its state for each node.
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

// Returns the area, in pixels, of the part of the convex hull of at most 8 points inside [0, size.x] x [0, size.y].
[[nodiscard]] double hull_area_inside(std::span<const glm::dvec2> points, const glm::dvec2& size);

// Returns the bias under plain screen-space error: everything visible counts in full.
[[nodiscard]] constexpr double no_bias(double mu) noexcept { return mu > 0.0 ? 1.0 : 0.0; }

// Computes from a node's bounds what traversal needs of one object in one view.
class ObjectFrame {
 public:
  ObjectFrame(const View& view, const PlacedHlod& placed, const Trial& trial = {});

  [[nodiscard]] double error_px(const Node& node) const;
  // Returns the error of the node refined within as far as possible.
  [[nodiscard]] double min_error_px(const Node& node) const;
  // Returns the error in object units that appears as this many pixels.
  [[nodiscard]] double error_limit(const Node& node, double pixels) const;
  // Returns the key by which nodes are ordered: the distance from the eye, or from the eye plane in orthographic views,
  // in world units.
  [[nodiscard]] double distance(const Box& box) const;
  // Returns false only when no point of the box is inside the frustum.
  [[nodiscard]] bool may_be_inside(const Box& box) const;
  // Returns the share of the image that a box covers by box_coverage(), even if it lies outside the frustum.
  [[nodiscard]] double coverage(const Box& box) const;
  // Returns the number of pixels of the image.
  [[nodiscard]] double pixels() const noexcept { return static_cast<double>(screen_.width) * screen_.height; }
  // Returns the number of pixels that the node's box covers on an empty screen, counted as `alpha` says. Returns
  // nothing where devices would count all pixels without drawing the box, as around the eye: such nodes are visible.
  [[nodiscard]] std::optional<double> box_pixels(const Node& node) const;

 private:
  [[nodiscard]] std::optional<double> outline_pixels(const Box& box) const;
  [[nodiscard]] double cube_pixels(const Node& node) const;

  ObjectView view_;
  ScreenScale scale_;
  Screen screen_;
  ProxySpace proxy_space_;
  glm::dvec4 depth_;     // dot product with (p, 1) is the distance from the eye plane, world units
  double volume_scale_;  // cubic world units per cubic object unit
  Metric metric_;
  Alpha alpha_;
};

// Names a node of one of the objects.
struct NodeRef {
  std::uint32_t object = 0;
  NodeId node = 0;
};

enum class Status : std::uint8_t {
  absent,          // no parent has been refined so far
  undecided,       // reached: in the queue, or a query is pending
  held,            // to be refined or refined within, but a parent is undecided
  refined,         // replaced by its children
  stopped,         // drawn where its parents are refined
  culled,          // outside the frustum, or hidden
  absent_stopped,  // never reached, since a coarser node is drawn
  absent_culled,   // never reached, since all coarser nodes are culled
};

// Tells what is known of a node from the last frame.
struct LastFrame {
  bool visited = false;  // reached, and inside the frustum
  bool visible = false;  // visited, and it or a node below it was seen
  bool refined = false;  // visited, and not stopped
  bool asked = false;    // reached, and queried
};

struct NodeState {
  std::uint32_t frame = 0;        // frame of the fields below; 0: none
  std::uint32_t floor_frame = 0;  // frame in which bias_floor was set
  float bias = 1.0F;              // by the last answer; 1 again when the last frame did not visit the node
  float bias_floor = 0.0F;        // least bias to assume in the frame after floor_frame
  NodeId first_held = no_id;      // first of the nodes that are held until this one is decided
  NodeId next_held = no_id;       // next node that is held for the same node
  float drawn_bias = 1.0F;        // bias with which the node is drawn, or will be drawn when it is no longer held
  Status status = Status::absent;
  bool visited : 1 = false;
  bool visible : 1 = false;
  bool asked : 1 = false;
  bool denied : 1 = false;        // was to be refined, but a parent was drawn
  bool floored : 1 = false;       // would have stopped without its bias_floor
  bool gone : 1 = false;          // found hidden after it was refined, or all its parents are gone or culled
  bool held_to_stop : 1 = false;  // held, and to be drawn refined within
  bool cut : 1 = false;           // drawn refined within
  bool delayed : 1 = false;       // drawn only when its answer came
  bool hidden : 1 = false;        // the answer was that it is hidden
  bool wasted : 1 = false;        // answered visible, which decided nothing
  bool answered : 1 = false;      // the answer was read
  bool through_hole : 1 = false;  // something nearer was drawn after the query that gave the bias: it may be too large
  bool asked_again : 1 = false;   // for that reason, and it has not stopped since: once is enough
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

// Starts the state's frame; call before its fields are used in this frame.
inline void enter_frame(NodeState& state, std::uint32_t frame) noexcept {
  if (state.frame == frame) return;
  const LastFrame last = last_frame(state, frame);
  if (!last.visited) {
    state.bias = 1.0F;
    state.through_hole = state.asked_again = false;
  }
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

struct ReachedNode {
  double distance = 0.0;  // see ObjectFrame::distance()
  NodeRef ref;
  std::uint32_t place = 0;  // number of nodes that were reached before it in this frame
};

// Orders the reached nodes by distance, nearest first. Breaks ties by object, then by node id, so coarse nodes come
// first.
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

// Holds the objects in the view of a frame, the options, and the states of all nodes.
class FrameScene {
 public:
  explicit FrameScene(std::span<const PlacedHlod> objects);

  // Forgets the states of all nodes.
  void forget();
  // Errors are multiplied by a bias for the visible share of a node if `biased` is true and the trial allows it.
  void begin_frame(const View& view, std::span<const PlacedHlod> objects, const TraverseOptions& options,
                   const Trial& trial, bool biased);

  // Ends the frame, in which `reached` nodes were reached.
  void end_frame(std::uint32_t reached) noexcept { reached_last_ = reached; }
  // Returns the number of nodes that were reached in the last frame; 0 before the first.
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

  // Returns the error of the node as it is.
  [[nodiscard]] double error_px(NodeRef n) const { return view_of(n).error_px(node(n)); }
  // Returns the smallest error of the node without replacing it by its children.
  [[nodiscard]] double min_error_px(NodeRef n) const {
    return may_be_cut(n) ? view_of(n).min_error_px(node(n)) : error_px(n);
  }
  // Returns the bias of a node of which the share mu is visible.
  [[nodiscard]] double bias(double mu) const noexcept { return biased_ ? options_.bias(mu) : no_bias(mu); }
  // Returns whether the node, refined within if need be, meets the tolerance with this bias. With a tolerance of 0 only
  // level 0 does, whatever the error.
  [[nodiscard]] bool is_within_tolerance(NodeRef n, double bias) const;
  // Returns whether the node cannot be refined in this frame because the mesh of a child that may be inside the frustum
  // is not loaded.
  [[nodiscard]] bool lacks_children(NodeRef n) const;
  // Returns whether the node is as fine as required, or as fine as loaded meshes allow.
  [[nodiscard]] bool is_fine(NodeRef n, double bias) const { return is_within_tolerance(n, bias) || lacks_children(n); }
  // Like is_fine(), but honours the floor that finer nodes set in the last frame with raise_floor(). Records when the
  // floor decides.
  [[nodiscard]] bool stops(NodeRef n, double bias);
  // Returns whether a node is fine enough with this bias only when it is refined within.
  [[nodiscard]] bool needs_cut(NodeRef n, double bias) const {
    return may_be_cut(n) && bias * error_px(n) > options_.tolerance_px && is_fine(n, bias);
  }
  // Returns the error, in object units, to which the node is refined within. bias > 0.
  [[nodiscard]] double cut_error(NodeRef n, double bias) const {
    return view_of(n).error_limit(node(n), options_.tolerance_px / bias);
  }
  // Returns the error of the node with this number of its splits applied, in pixels.
  [[nodiscard]] double cut_error_px(NodeRef n, std::uint32_t splits) const {
    const double error = error_of_splits(hlod(n), n.node, splits);
    return std::max(error / view_of(n).error_limit(node(n), 1.0), min_error_px(n));
  }
  // Tells the store that this frame uses the node's mesh, if it is loaded.
  void need(NodeRef n) const;
  // Returns whether the children that may be inside the frustum are loaded; reads them if the store is blocking.
  [[nodiscard]] bool fetch_children(NodeRef n);
  // Asks the store for these children, because the node is drawn with this bias without them.
  void want_children(NodeRef n, double bias);
  // Lets the node be refined in the next frame, since a finer node cannot be drawn otherwise. Call it only where the
  // node's bias alone prevents that.
  void raise_floor(NodeRef n);

 private:
  [[nodiscard]] bool may_be_cut(NodeRef n) const {
    return options_.within && options_.tolerance_px > 0.0 && hlod(n).has_within(n.node);
  }

  void find_children_inside(NodeRef n);

  std::vector<const Hlod*> hlods_;
  std::vector<NodeStore*> stores_;              // per object; null when all its meshes are in memory
  std::vector<NodeId> children_inside_;         // scratch memory
  std::vector<std::vector<NodeState>> states_;  // per object, then per node
  std::vector<ObjectFrame> frames_;             // per object
  TraverseOptions options_;
  Trial trial_;
  bool biased_ = false;
  std::uint32_t frame_ = 0;
  std::uint32_t reached_last_ = 0;
};

}  // namespace occlod::hlod
