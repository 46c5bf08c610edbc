// What a frame is traversed with: the objects in its view, and their nodes' states.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "occlod/hlod/node_store.h"
#include "occlod/hlod/within.h"
#include "hlod/draw/node_state.h"
#include "hlod/draw/object_frame.h"

namespace occlod::hlod {

class FrameScene {
 public:
  explicit FrameScene(std::span<const PlacedHlod> objects);

  // Forgets all that is known of nodes.
  void forget();
  // biased: errors are compared by what is visible of nodes, where the options say so too.
  void begin_frame(const View& view, std::span<const PlacedHlod> objects, const TraverseOptions& options, bool biased);

  // Nodes that were reached in this frame.
  void end_frame(std::uint32_t reached) noexcept { reached_last_ = reached; }
  // Nodes that were reached in the last frame; 0 before the first.
  [[nodiscard]] std::uint32_t reached_last() const noexcept { return reached_last_; }

  [[nodiscard]] std::uint32_t frame() const noexcept { return frame_; }
  [[nodiscard]] const TraverseOptions& options() const noexcept { return options_; }
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
  [[nodiscard]] double least_error_px(NodeRef n) const {
    return may_be_cut(n) ? view_of(n).least_error_px(node(n)) : error_px(n);
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
    return std::max(error / view_of(n).error_limit(node(n), 1.0), least_error_px(n));
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
  bool biased_ = false;
  std::uint32_t frame_ = 0;
  std::uint32_t reached_last_ = 0;
};

}  // namespace occlod::hlod
