#include "traverse/traversal.h"

#include <algorithm>
#include <optional>

namespace occlod::hlod {
namespace {

// The visible share of a box, from two counts of pixels. Flat boxes cover none by the paper's alpha.
double share(std::uint32_t visible, double all) {
  const auto count = static_cast<double>(visible);
  return count < all ? count / all : std::min(count, 1.0);
}

}  // namespace

Traversal::Traversal(FrameScene& scene, const Policy& policy, RenderDevice& device, TraversalMemory& memory,
                     Frame& frame)
    : scene_(scene),
      policy_(policy),
      device_(device),
      memory_(memory),
      stats_(frame.stats),
      draws_(scene, device, frame),
      front_(scene, memory.reached, draws_) {
  memory_.asked.clear();
}

void Traversal::run() {
  front_.reach_roots();
  DistanceQueue& reached = memory_.reached;
  while (!reached.empty() || settled_ < memory_.asked.size()) {
    // Waits only when there is nothing else to do.
    while (settled_ < memory_.asked.size() && (reached.empty() || device_.available(memory_.asked[settled_].query)))
      settle_next();
    if (!reached.empty()) visit(reached.pop());
  }
  scene_.end_frame(front_.reached());
}

void Traversal::visit(const ReachedNode& reached) {
  const NodeRef n = reached.ref;
  NodeState& state = scene_.state(n);
  if (state.status == Status::held) return want_refined(n);
  if (!scene_.view_of(n).may_be_inside(scene_.node(n).box)) return front_.cull(n);
  ++stats_.visits;
  device_.visit(1);
  state.visited = true;
  predict(reached);
}

void Traversal::predict(const ReachedNode& reached) {
  const NodeRef n = reached.ref;
  const Action action = policy_.predict(scene_, reached);
  if (action == Action::refine) return want_refined(n);
  if (!policy_.asks()) return front_.stop(n);
  const std::optional<double> pixels = scene_.view_of(n).box_pixels(scene_.node(n));
  if (!pixels) return settle(n, 1.0);
  ask(n, *pixels);
  if (action == Action::stop) front_.stop(n);  // after the query: a flat node must not hide its own box
  if (policy_.waits()) settle_next();
}

void Traversal::ask(NodeRef n, double pixels) {
  const BoxRef box{n.object, scene_.node(n).box};
  scene_.state(n).asked = true;
  memory_.asked.push_back({n, device_.ask({&box, 1}), pixels});
  ++stats_.queries;
}

void Traversal::settle_next() {
  const AskedNode asked = memory_.asked[settled_++];
  const std::uint32_t visible = device_.wait(asked.query)[0];
  if (visible > 0) return settle(asked.ref, share(visible, asked.pixels));
  ++stats_.hidden_nodes;
  NodeState& state = scene_.state(asked.ref);
  state.bias = 0.0F;
  if (state.status == Status::undecided) front_.cull(asked.ref);
}

// Of a node that is visible.
void Traversal::settle(NodeRef n, double mu) {
  NodeState& state = scene_.state(n);
  const double bias = scene_.bias(mu);
  state.bias = static_cast<float>(bias);
  front_.see(n);
  const bool is_fine = scene_.stops(n, bias);
  if (state.status == Status::stopped) return settle_drawn(n, is_fine);
  if (!is_fine) return want_refined(n);
  if (state.asked && is_drawable(n)) ++stats_.delayed;
  front_.stop(n);
}

// Drawn when it was asked about, because it was predicted to stop or had to.
void Traversal::settle_drawn(NodeRef n, bool is_fine) {
  if (!is_fine && front_.may_refine(n) == Permission::granted) {
    if (is_drawable(n)) ++stats_.rarn;
    front_.keep_floors(n);
    return front_.refine(n);
  }
  ++stats_.wasted_queries;
  if (!is_fine) note_denied(n);
}

// A root where everything has vanished has nothing to draw. Any other node that stops draws a patch: a parent of it is
// refined, or it would not have been reached.
bool Traversal::is_drawable(NodeRef n) const { return scene_.node(n).patches > 0; }

void Traversal::want_refined(NodeRef n) {
  switch (front_.may_refine(n)) {
    case Permission::granted:
      front_.keep_floors(n);
      return front_.refine(n);
    case Permission::pending:
      return front_.hold(n);
    case Permission::denied:
      return draw_denied(n);
  }
}

// A node that is asked about anyway was visible: the answer decides nothing but what the next frame predicts.
void Traversal::draw_denied(NodeRef n) {
  note_denied(n);
  const NodeState& state = scene_.state(n);
  if (state.asked) {
    if (is_drawable(n)) ++stats_.delayed;
  } else if (!state.visible) {
    if (const std::optional<double> pixels = scene_.view_of(n).box_pixels(scene_.node(n)))
      ask(n, *pixels);
    else
      front_.see(n);
  }
  front_.stop(n);
}

void Traversal::note_denied(NodeRef n) {
  NodeState& state = scene_.state(n);
  if (!state.denied) ++stats_.blocked;
  state.denied = true;
  front_.raise_floors(n);
}

}  // namespace occlod::hlod
