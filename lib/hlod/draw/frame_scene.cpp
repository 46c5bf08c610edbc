#include "hlod/draw/frame_scene.h"

#include <algorithm>
#include <limits>

namespace occlod::hlod {

FrameScene::FrameScene(std::span<const PlacedHlod> objects) {
  for (const PlacedHlod& object : objects) {
    hlods_.push_back(object.hlod);
    stores_.push_back(object.hlod->store());
    states_.emplace_back(object.hlod->node_count());
  }
}

void FrameScene::forget() {
  for (std::vector<NodeState>& states : states_) std::fill(states.begin(), states.end(), NodeState());
  frame_ = 0;
  reached_last_ = 0;
}

void FrameScene::begin_frame(const View& view, std::span<const PlacedHlod> objects, const TraverseOptions& options,
                             bool biased) {
  if (frame_ == std::numeric_limits<std::uint32_t>::max() - 1) forget();
  ++frame_;
  options_ = options;
  biased_ = biased && options.biased;
  frames_.clear();
  for (const PlacedHlod& object : objects) frames_.emplace_back(view, object, options);
}

bool FrameScene::is_within_tolerance(NodeRef n, double bias) const {
  return node(n).level == 0 || (options_.tolerance_px > 0.0 && bias * least_error_px(n) <= options_.tolerance_px);
}

bool FrameScene::lacks_children(NodeRef n) const {
  const NodeStore* const store = stores_[n.object];
  return store != nullptr && std::ranges::any_of(hlod(n).children(n.node), [&](NodeId child) {
           return !store->may_have(child) && view_of(n).may_be_inside(hlod(n).node(child).box);
         });
}

void FrameScene::need(NodeRef n) const {
  if (stores_[n.object] != nullptr && hlod(n).is_resident(n.node)) stores_[n.object]->need(n.node);
}

void FrameScene::find_children_inside(NodeRef n) {
  children_inside_.clear();
  for (const NodeId child : hlod(n).children(n.node))
    if (view_of(n).may_be_inside(hlod(n).node(child).box)) children_inside_.push_back(child);
}

bool FrameScene::fetch_children(NodeRef n) {
  if (stores_[n.object] == nullptr) return true;
  find_children_inside(n);
  return stores_[n.object]->fetch(children_inside_);
}

void FrameScene::want_children(NodeRef n, double bias) {
  find_children_inside(n);
  stores_[n.object]->want(children_inside_, bias * error_px(n));
}

bool FrameScene::stops(NodeRef n, double bias) {
  if (!is_fine(n, bias)) return false;
  NodeState& s = state(n);
  const bool has_floor = s.floor_frame != 0 && s.floor_frame + 1 == frame_;
  if (!has_floor || static_cast<double>(s.bias_floor) <= bias || is_fine(n, static_cast<double>(s.bias_floor)))
    return true;
  s.floored = true;
  return false;
}

void FrameScene::raise_floor(NodeRef n) {
  constexpr double beyond = 1.01;  // the tolerance
  NodeState& s = state(n);
  s.bias_floor = static_cast<float>(std::min(1.0, beyond * options_.tolerance_px / least_error_px(n)));
  s.floor_frame = frame_;
}

}  // namespace occlod::hlod
