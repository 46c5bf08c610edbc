#include "hlod/draw/traversal.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace occlod::hlod {
namespace {

// CHC++ keeps as many hidden nodes (Mattausch and others 2008, sec. 5.1).
constexpr std::size_t max_hidden = 50;

}  // namespace

void Questions::begin_frame(FrameScene& scene, Policy& policy, RenderDevice& device, Frame& frame) {
  scene_ = &scene;
  policy_ = &policy;
  device_ = &device;
  frame_ = &frame;
  asked_.clear();
  kept_.clear();
  hidden_.clear();
  urgent_.clear();
  last_.clear();
  settled_ = kept_asked_ = 0;
}

void Questions::ask(const AskedNode& n, bool was_visible) {
  switch (policy_->asking()) {
    case Asking::singly:
      return ask_singly(n);
    case Asking::by_rounds:
      return kept_.push_back(n);
    case Asking::late:
      if (was_visible) return keep(n);
      return urgent_.push({scene_->view_of(n.ref).distance(scene_->node(n.ref).box), n.ref, 0});
    case Asking::by_groups:
      if (was_visible) return keep(n);
      hidden_.push_back(n.ref);
      if (hidden_.size() >= max_hidden) ask_groups();
  }
}

// Keeps a formerly visible node for later. What was refined by an answer through a hole waits until there is none.
void Questions::keep(const AskedNode& n) {
  NodeState& state = scene_->state(n.ref);
  state.asked_again = state.asked_again || (state.through_hole && scene_->last(n.ref).refined);
  (state.through_hole && state.asked_again ? last_ : kept_).push_back(n);
}

void Questions::ask_singly(const AskedNode& n) {
  boxes_.clear();
  policy_->add_boxes(*scene_, n.ref, boxes_);
  asked_.push_back({.node = n, .query = device_->ask(boxes_), .draws = frame_->draws.size()});
  ++frame_->stats.queries;
}

void Questions::ask_round() {
  const bool pays = policy_->end_round(*scene_, kept_.size());
  if (pays) {
    boxes_.clear();
    for (const AskedNode& n : kept_) boxes_.push_back({n.ref.object, scene_->node(n.ref).box});
    const std::span<const std::uint32_t> counts = device_->wait(device_->ask_each(boxes_));
    for (std::size_t i = 0; i < kept_.size(); ++i)
      asked_.push_back({.node = kept_[i], .visible = counts[i], .draws = frame_->draws.size()});
    frame_->stats.queries += kept_.size();
  } else {
    for (const AskedNode& n : kept_) asked_.push_back({.node = n, .was_asked = false});
  }
  for (std::size_t i = settled_; i < asked_.size(); ++i) asked_[i].is_known = true;
  kept_.clear();
}

AskedNode Questions::with_pixels(NodeRef n) const {
  return {n, scene_->view_of(n).box_pixels(scene_->node(n)).value_or(0.0)};
}

void Questions::ask_groups() {
  std::span<NodeRef> rest = hidden_;
  while (!rest.empty()) {
    const std::size_t size = policy_->group(*scene_, rest);
    if (size == 1) {
      ask_singly(with_pixels(rest.front()));
      rest = rest.subspan(1);
      continue;
    }
    boxes_.clear();
    for (const NodeRef n : rest.first(size)) policy_->add_boxes(*scene_, n, boxes_);
    const QueryId query = device_->ask(boxes_);
    for (const NodeRef n : rest.first(size))
      asked_.push_back({.node = {n, 0.0}, .query = query, .group = static_cast<std::uint32_t>(size)});
    ++frame_->stats.queries;
    rest = rest.subspan(size);
  }
  hidden_.clear();
}

// Queries one of the nodes that were kept for idle moments. Returns whether there was any.
bool Questions::ask_kept(bool is_waiting) {
  if (!urgent_.empty()) {
    ask_singly(with_pixels(urgent_.pop().ref));
    return true;
  }
  if (!is_waiting || kept_asked_ == kept_.size()) return false;
  ask_singly(kept_[kept_asked_++]);
  return true;
}

// Settles a group as hidden, or queries its nodes one by one.
void Questions::settle_group() {
  const std::size_t size = asked_[settled_].group;
  if (device_->wait(asked_[settled_].query)[0] == 0) {
    for (std::size_t i = settled_; i < settled_ + size; ++i) asked_[i].is_known = true;
    return;
  }
  ++frame_->stats.wasted_queries;
  for (std::size_t i = settled_; i < settled_ + size; ++i) ask_singly(with_pixels(asked_[i].node.ref));
  settled_ += size;
}

// Returns whether the answer is not needed, because the node lies below a hidden one.
bool Questions::is_gone(const Question& question) const { return scene_->state(question.node.ref).gone; }

bool Questions::is_answered(const Question& question) {
  return question.is_known || is_gone(question) || asked_.size() - settled_ >= policy_->max_asked() ||
         device_->available(question.query);
}

bool Questions::may_look(bool idle) {
  while (true) {
    const bool is_waiting = settled_ < asked_.size();
    if (!is_waiting || !is_answered(asked_[settled_])) {
      if (!idle || !policy_->waits_for_late_answers()) return false;
      if (ask_kept(is_waiting)) continue;
      if (!is_waiting) return false;
    }
    if (asked_[settled_].is_known || asked_[settled_].group == 1) return true;
    settle_group();
  }
}

AnsweredNode Questions::next() {
  const Question& question = asked_[settled_++];
  AnsweredNode answered{question.node.ref, question.node.pixels, question.visible, question.was_asked};
  if (!question.is_known && !is_gone(question)) answered.visible = device_->wait(question.query)[0];
  return answered;
}

bool Questions::ask_waiting() {
  if (policy_->asking() == Asking::by_rounds) {
    if (kept_.empty()) return false;
    ask_round();
    return true;
  }
  if (!hidden_.empty()) {
    ask_groups();
    return true;
  }
  if (kept_asked_ < kept_.size()) {
    ask_singly(kept_[kept_asked_++]);
    return true;
  }
  if (last_.empty()) return false;
  for (const AskedNode& n : last_) ask_singly(n);
  last_.clear();
  return true;
}

void Questions::mark_holes() {
  if (!policy_->biased()) return;
  std::size_t draws = frame_->draws.size();
  double nearest = std::numeric_limits<double>::infinity();  // of what was drawn after the query
  for (std::size_t i = asked_.size(); i-- > 0;) {
    const Question& question = asked_[i];
    for (; draws > question.draws; --draws) {
      const DrawnNode& drawn = frame_->draws[draws - 1];
      nearest = std::min(nearest, distance_of({drawn.object, drawn.node}));
    }
    NodeState& state = scene_->state(question.node.ref);
    if (!state.answered || !question.was_asked || question.group > 1) continue;
    state.asked_again = state.asked_again && state.status == Status::refined;
    state.through_hole = nearest < distance_of(question.node.ref) && !state.asked_again;
  }
}

double Questions::distance_of(NodeRef n) const { return scene_->view_of(n).distance(scene_->node(n).box); }

namespace {

// Returns the visible share of a box from two counts of pixels. By the paper's alpha, flat boxes cover none.
double share(std::uint32_t visible, double all) {
  const auto count = static_cast<double>(visible);
  return count < all ? count / all : std::min(count, 1.0);
}

}  // namespace

Traversal::Traversal(FrameScene& scene, Policy& policy, RenderDevice& device, TraversalMemory& memory, Frame& frame)
    : scene_(scene),
      policy_(policy),
      device_(device),
      memory_(memory),
      stats_(frame.stats),
      asked_(frame.asked),
      draws_(scene, device, memory.cuts, frame),
      front_(scene, memory.reached, draws_) {
  memory_.questions.begin_frame(scene, policy, device, frame);
  memory_.cuts.begin_frame();
}

void Traversal::run() {
  policy_.begin_frame(scene_);
  front_.reach_roots();
  DistanceQueue& reached = memory_.reached;
  Questions& questions = memory_.questions;
  while (true) {
    // Wait only when there is nothing else to do.
    while (questions.may_look(reached.empty())) settle_next();
    if (!reached.empty())
      visit(reached.pop());
    else if (!questions.ask_waiting())
      break;
  }
  questions.mark_holes();
  policy_.end_frame(scene_);
  scene_.end_frame(front_.reached());
}

void Traversal::visit(const ReachedNode& reached) {
  const NodeRef n = reached.ref;
  NodeState& state = scene_.state(n);
  if (state.gone) return front_.cull(n);
  if (state.status == Status::held)
    return state.held_to_stop ? stop(n, static_cast<double>(state.drawn_bias)) : want_refined(n);
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
  if (action == Action::draw) {
    see_unasked(n);
    return stop(n, 1.0);
  }
  const std::optional<double> pixels = scene_.view_of(n).box_pixels(scene_.node(n));
  if (!pixels) return settle(n, 1.0);
  ask(n, *pixels, action == Action::stop || action == Action::descend);
  act(reached, action);
}

// Must come after the query, because a flat node must not hide its own box.
void Traversal::act(const ReachedNode& reached, Action action) {
  const NodeRef n = reached.ref;
  if (action == Action::stop) stop(n, policy_.bias(scene_, reached));
  if (action == Action::descend) want_refined(n);
  if (action == Action::drop) {
    ++stats_.hidden_nodes;
    NodeState& state = scene_.state(n);
    state.answered = state.hidden = true;
    front_.cull(n);
  }
  if (policy_.waits()) settle_next();
}

void Traversal::ask(NodeRef n, double pixels, bool was_visible) {
  scene_.state(n).asked = true;
  asked_.push_back({n.object, n.node});
  memory_.questions.ask({n, pixels}, was_visible);
}

// Draws a node that is fine enough with this bias, refined within if need be, which requires the permission to refine.
void Traversal::stop(NodeRef n, double bias) {
  NodeState& state = scene_.state(n);
  state.drawn_bias = static_cast<float>(bias);
  state.held_to_stop = false;
  if (!scene_.needs_cut(n, bias)) return draw_whole(n, bias);
  switch (front_.may_refine(n)) {
    case Permission::granted:
      front_.stop_within(n, scene_.cut_error(n, bias));
      return policy_.note_drawn(scene_, n);
    case Permission::pending:
      state.held_to_stop = true;
      return front_.hold(n);
    case Permission::denied:
      note_denied(n);
      return draw_whole(n, bias);
  }
}

void Traversal::draw_whole(NodeRef n, double bias) {
  front_.stop(n);
  policy_.note_drawn(scene_, n);
  note_waiting(n, bias);
}

void Traversal::settle_next() {
  const AnsweredNode answered = memory_.questions.next();
  const NodeRef n = answered.ref;
  NodeState& state = scene_.state(n);
  if (!policy_.answers_decide()) {
    policy_.note_answer(scene_, n, answered.visible > 0);
    state.answered = true;
    state.hidden = answered.visible == 0;
    if (answered.visible == 0 && state.status != Status::culled) ++stats_.hidden_nodes;
    return;
  }
  if (!answered.was_asked) state.asked = false;
  if (state.gone) {
    if (state.status == Status::undecided) front_.cull(n);
    return;
  }
  if (!answered.was_asked) return settle_unasked(n);
  policy_.note_answer(scene_, n, answered.visible > 0);
  state.answered = true;
  state.hidden = answered.visible == 0;
  if (answered.visible > 0) return settle(n, share(answered.visible, answered.pixels));
  ++stats_.hidden_nodes;
  settle_hidden(n);
}

// Marks the node as visible without a query. Its bias stays if the node was visible in the last frame.
void Traversal::see_unasked(NodeRef n) {
  if (!scene_.last(n).visible) scene_.state(n).bias = 1.0F;
  front_.see(n);
}

void Traversal::settle_unasked(NodeRef n) {
  see_unasked(n);
  if (scene_.state(n).status != Status::undecided) return;
  if (scene_.is_fine(n, 1.0)) return stop(n, 1.0);
  want_refined(n);
}

void Traversal::settle_hidden(NodeRef n) {
  NodeState& state = scene_.state(n);
  // It is asked again only for its bias, while its children, which are asked too, are drawn.
  if (state.status == Status::refined && state.through_hole) return;
  // What is below it may have been seen before this answer, so that it counts as visible in the next frame: hardly,
  // or in full where there is no bias.
  constexpr double hardly = 1e-300;
  state.bias = static_cast<float>(scene_.bias(hardly));
  if (state.status == Status::undecided) return front_.cull(n);
  if (state.status == Status::refined || state.status == Status::held) front_.hide(n);
}

// Decides about a visible node of which the share mu is visible.
void Traversal::settle(NodeRef n, double mu) {
  NodeState& state = scene_.state(n);
  const double bias = scene_.bias(mu);
  state.bias = static_cast<float>(bias);
  front_.see(n);
  if (state.held_to_stop) return settle_held(n, bias);
  if (state.status == Status::refined || state.status == Status::held) {  // it was Action::descend
    if (!scene_.is_fine(n, bias)) note_wasted(n);                         // otherwise the next frame makes use of it
    return;
  }
  const bool is_fine = scene_.stops(n, bias);
  if (state.status == Status::stopped) return settle_drawn(n, is_fine, bias);
  if (!is_fine) return want_refined(n);
  if (state.asked && is_drawable(n)) note_delayed(n);
  stop(n, bias);
}

// Updates a node that was predicted to stop but is not drawn yet: now its bias is known, or that it must be refined.
void Traversal::settle_held(NodeRef n, double bias) {
  NodeState& state = scene_.state(n);
  state.held_to_stop = scene_.stops(n, bias);
  state.drawn_bias = static_cast<float>(bias);
}

// Corrects a node that was drawn before its answer came, because it was predicted to stop or had to.
void Traversal::settle_drawn(NodeRef n, bool is_fine, double bias) {
  if (!is_fine && front_.may_refine(n) == Permission::granted) {
    if (!scene_.fetch_children(n)) {
      note_wasted(n);
      return note_waiting(n, bias);
    }
    if (is_drawable(n)) ++stats_.rarn;
    front_.keep_floors(n);
    return front_.refine(n);
  }
  if (is_fine && draw_finer(n, bias)) return;
  note_wasted(n);
  if (!is_fine) note_denied(n);
}

// Redraws a node that was refined too little within, or not at all, because its bias was too small.
bool Traversal::draw_finer(NodeRef n, double bias) {
  NodeState& state = scene_.state(n);
  const auto drawn_bias = static_cast<double>(state.drawn_bias);
  if (!(bias > drawn_bias) || !scene_.needs_cut(n, bias)) return false;
  if (front_.may_refine(n) != Permission::granted) {
    note_denied(n);
    return false;
  }
  if (!draws_.draw_finer_cut(n, scene_.cut_error(n, bias), scene_.cut_error(n, drawn_bias))) return false;
  if (!state.cut) ++stats_.cut_nodes;
  state.cut = true;
  ++stats_.recut_nodes;
  return true;
}

// Returns whether the node has anything to draw, unlike a root where everything has vanished. Any other node that stops
// draws a patch: a parent of it is refined, or it would not have been reached.
bool Traversal::is_drawable(NodeRef n) const { return scene_.node(n).patches > 0; }

void Traversal::want_refined(NodeRef n) {
  switch (front_.may_refine(n)) {
    case Permission::granted:
      if (!scene_.fetch_children(n)) return draw_unrefined(n);
      front_.keep_floors(n);
      return front_.refine(n);
    case Permission::pending:
      return front_.hold(n);
    case Permission::denied:
      note_denied(n);
      return draw_unrefined(n);
  }
}

// Draws a node that must not be refined. If it is queried at all, it was visible, and the answer only affects what the
// next frame predicts.
void Traversal::draw_unrefined(NodeRef n) {
  const NodeState& state = scene_.state(n);
  if (state.asked) {
    if (is_drawable(n)) note_delayed(n);
  } else if (!state.visible) {
    if (const std::optional<double> pixels = scene_.view_of(n).box_pixels(scene_.node(n)))
      ask(n, *pixels, true);
    else
      front_.see(n);
  }
  draw_whole(n, static_cast<double>(state.bias));
}

void Traversal::note_delayed(NodeRef n) {
  ++stats_.delayed;
  scene_.state(n).delayed = true;
}

void Traversal::note_wasted(NodeRef n) {
  ++stats_.wasted_queries;
  scene_.state(n).wasted = true;
}

// Records when a node was drawn with this bias for want of a mesh.
void Traversal::note_waiting(NodeRef n, double bias) {
  if (scene_.is_within_tolerance(n, bias) || !scene_.lacks_children(n)) return;
  if (is_drawable(n)) ++stats_.waiting_nodes;
  scene_.want_children(n, bias);
}

void Traversal::note_denied(NodeRef n) {
  NodeState& state = scene_.state(n);
  if (!state.denied) ++stats_.blocked;
  state.denied = true;
  front_.raise_floors(n);
}

}  // namespace occlod::hlod
