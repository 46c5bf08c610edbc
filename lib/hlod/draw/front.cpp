#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cassert>

#include "hlod/draw/traversal.h"

namespace occlod::hlod {

// Joins neighbouring patches that morph alike into one range. A sum of hashes does not depend on the order of draws.
void DrawRecorder::add(NodeRef n, const Patch& patch, std::uint32_t place) {
  const DrawRange range{patch.first_index, patch.index_count, morph(n, patch.parent)};
  std::vector<DrawRange>& ranges = frame_.ranges;
  const bool goes_on = ranges.size() > first_range_ && ranges.back().morph == range.morph &&
                       ranges.back().first_index + ranges.back().index_count == range.first_index;
  if (goes_on)
    ranges.back().index_count += range.index_count;
  else
    ranges.push_back(range);
  const std::array<std::uint32_t, 3> key{n.object, n.node, place};
  frame_.front_hash += XXH3_64bits(key.data(), sizeof(key));
  ++frame_.stats.drawn_patches;
  frame_.stats.drawn_triangles += patch.index_count / 3;
}

void DrawRecorder::submit(NodeRef n, bool first) {
  const std::span<const DrawRange> ranges = std::span(frame_.ranges).subspan(first_range_);
  frame_.draws.push_back(
      {n.object, n.node, static_cast<std::uint32_t>(first_range_), static_cast<std::uint32_t>(ranges.size())});
  if (first) ++frame_.stats.drawn_nodes;
  frame_.stats.largest_sse_px = std::max(frame_.stats.largest_sse_px, scene_.error_px(n));
  device_.draw({n.object, n.node, ranges, {}, 0});
}

bool DrawRecorder::draw_cut(NodeRef n, bool first, double max_error) {
  const NodeCut& cut = cuts_.get(scene_.hlod(n), n.node, max_error);
  if (cut.splits == 0) return false;
  submit_cut(n, first, cut);
  return true;
}

bool DrawRecorder::draw_finer_cut(NodeRef n, double max_error, double drawn_error) {
  const std::uint32_t drawn = cuts_.get(scene_.hlod(n), n.node, drawn_error).splits;
  const NodeCut& cut = cuts_.get(scene_.hlod(n), n.node, max_error);
  if (cut.splits <= drawn) return false;
  submit_cut(n, false, cut);
  return true;
}

void DrawRecorder::submit_cut(NodeRef n, bool first, const NodeCut& cut) {
  if (cut.indices.empty()) return;  // everything has vanished
  FrameStats& stats = frame_.stats;
  frame_.draws.push_back(
      {n.object, n.node, static_cast<std::uint32_t>(frame_.ranges.size()), 0, 1.0F, cut.indices, cut.splits});
  const std::array<std::uint32_t, 3> key{n.object, n.node, no_id - cut.splits};
  frame_.front_hash += XXH3_64bits(key.data(), sizeof(key));
  if (first) {
    ++stats.drawn_nodes;
    ++stats.cut_nodes;
  }
  stats.drawn_triangles += cut.indices.size() / 3;
  stats.largest_sse_px = std::max(stats.largest_sse_px, scene_.cut_error_px(n, cut.splits));
  device_.draw({n.object, n.node, {}, cut.indices, cut.splits});
}

// Returns 1, as in the parent, where the parent's error is the tolerance, down to 0, as in the mesh, where it is twice
// that.
float DrawRecorder::morph(NodeRef n, NodeId parent) const {
  const TraverseOptions& options = scene_.options();
  if (!options.geomorph || parent == no_id || !(options.tolerance_px > 0.0)) return 0.0F;
  const double error = scene_.error_px({n.object, parent});
  return static_cast<float>(std::clamp(2.0 - error / options.tolerance_px, 0.0, 1.0));
}

namespace {

bool is_undecided(Status status) { return status == Status::undecided || status == Status::held; }
bool is_drawn(Status status) { return status == Status::stopped || status == Status::absent_stopped; }

}  // namespace

template <typename Visit>
void Front::for_each_parent(NodeRef n, const Visit& visit) const {
  for (const Patch& patch : scene_.hlod(n).patches(n.node))
    if (patch.parent != no_id) visit(NodeRef{n.object, patch.parent});
}

Front::Front(FrameScene& scene, DistanceQueue& queue, DrawRecorder& draws)
    : scene_(scene), queue_(queue), draws_(draws) {
  queue_.clear();
}

void Front::reach_roots() {
  for (std::uint32_t object = 0; object < scene_.object_count(); ++object)
    for (const NodeId root : scene_.hlod({object, 0}).data().roots) reach({object, root});
}

void Front::reach(NodeRef n) {
  NodeState& state = scene_.state(n);
  enter_frame(state, scene_.frame());
  state.status = Status::undecided;
  scene_.need(n);
  queue_.push({scene_.view_of(n).distance(scene_.node(n).box), n, reached_++});
}

// The parents of a node that was never reached determine its status: none of them is refined. The result holds for the
// frame, unless a drawn node is refined after all; then its children are reached.
Status Front::resolve(NodeRef n) {
  NodeState& state = scene_.state(n);
  enter_frame(state, scene_.frame());
  if (is_undecided(state.status)) undecided_ = n;
  if (state.status != Status::absent) return state.status;
  Status found = Status::absent_culled;
  for (const Patch& patch : scene_.hlod(n).patches(n.node)) {
    const Status parent = resolve({n.object, patch.parent});  // roots are never absent
    assert(parent != Status::refined);
    if (is_undecided(parent)) return parent;
    if (is_drawn(parent)) found = Status::absent_stopped;
  }
  return state.status = found;
}

Permission Front::may_refine(NodeRef n) {
  Permission permission = Permission::granted;
  for (const Patch& patch : scene_.hlod(n).patches(n.node)) {
    if (patch.parent == no_id) continue;
    const Status parent = resolve({n.object, patch.parent});
    if (is_undecided(parent)) return Permission::pending;
    if (is_drawn(parent)) permission = Permission::denied;
  }
  return permission;
}

void Front::refine(NodeRef n) {
  scene_.state(n).status = Status::refined;
  bool sees = false;
  for (const NodeId id : scene_.hlod(n).children(n.node)) {
    const NodeRef child{n.object, id};
    NodeState& state = scene_.state(child);
    enter_frame(state, scene_.frame());
    sees = sees || state.visible;
    if (state.status == Status::absent || state.status == Status::absent_stopped ||
        state.status == Status::absent_culled)
      reach(child);
    else if (state.status == Status::stopped && !state.cut)
      draws_.draw(child, false, [&](NodeId parent) { return parent == n.node; });
  }
  if (sees) see(n);
  requeue_held(scene_.state(n), n.object);
}

void Front::hold(NodeRef n) {
  const Permission permission = may_refine(n);
  assert(permission == Permission::pending && undecided_.node < n.node);  // coarser, so nodes never wait in a circle
  static_cast<void>(permission);
  NodeState& state = scene_.state(n);
  NodeState& awaited = scene_.state(undecided_);
  state.status = Status::held;
  state.next_held = awaited.first_held;
  awaited.first_held = n.node;
}

void Front::requeue_held(NodeState& state, std::uint32_t object) {
  NodeId next = state.first_held;
  state.first_held = no_id;
  while (next != no_id) {
    const NodeRef n{object, next};
    next = scene_.state(n).next_held;
    queue_.push({scene_.view_of(n).distance(scene_.node(n).box), n, 0});
  }
}

void Front::stop(NodeRef n) {
  NodeState& state = scene_.state(n);
  state.status = Status::stopped;
  draws_.draw(n, true, [&](NodeId parent) {
    if (parent == no_id) return true;
    const NodeState& s = scene_.state({n.object, parent});
    return s.frame == scene_.frame() && s.status == Status::refined;
  });
  requeue_held(state, n.object);
}

void Front::stop_within(NodeRef n, double max_error) {
  NodeState& state = scene_.state(n);
  state.cut = draws_.draw_cut(n, true, max_error);
  if (!state.cut) return stop(n);
  state.status = Status::stopped;
  requeue_held(state, n.object);
}

void Front::cull(NodeRef n) {
  NodeState& state = scene_.state(n);
  state.status = Status::culled;
  requeue_held(state, n.object);
}

bool Front::is_gone(NodeRef n) const {
  const NodeState& state = scene_.state(n);
  return state.frame == scene_.frame() && (state.gone || state.status == Status::culled);
}

void Front::hide(NodeRef n) {
  NodeState& state = scene_.state(n);
  state.gone = true;
  state.visible = false;
  if (state.status != Status::refined) return;
  for (const NodeId id : scene_.hlod(n).children(n.node)) {
    const NodeRef child{n.object, id};
    const NodeState& reached = scene_.state(child);
    if (reached.frame != scene_.frame() || reached.status == Status::absent || reached.gone) continue;
    bool is_needed = false;
    for_each_parent(child, [&](NodeRef parent) { is_needed = is_needed || !is_gone(parent); });
    if (!is_needed) hide(child);
  }
}

void Front::see(NodeRef n) {
  NodeState& state = scene_.state(n);
  if (state.visible) return;
  state.visible = true;
  for_each_parent(n, [&](NodeRef parent) {
    const NodeState& s = scene_.state(parent);
    if (s.frame == scene_.frame() && s.status == Status::refined) see(parent);
  });
}

void Front::raise_floors(NodeRef n) {
  for_each_parent(n, [&](NodeRef parent) {
    const NodeState& s = scene_.state(parent);
    if (s.frame != scene_.frame() || !is_drawn(s.status) || s.floor_frame == scene_.frame()) return;
    scene_.raise_floor(parent);
    if (s.status == Status::absent_stopped) raise_floors(parent);
  });
}

void Front::keep_floors(NodeRef n) {
  for_each_parent(n, [&](NodeRef parent) {
    if (scene_.state(parent).floored) scene_.raise_floor(parent);
  });
}

}  // namespace occlod::hlod
