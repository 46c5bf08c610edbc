#include "hlod/draw/questions.h"

namespace occlod::hlod {
namespace {

// As many hidden nodes as CHC++ keeps (Mattausch and others 2008, sec. 5.1).
constexpr std::size_t most_hidden = 50;

}  // namespace

void Questions::begin_frame(const FrameScene& scene, Policy& policy, RenderDevice& device, FrameStats& stats) {
  scene_ = &scene;
  policy_ = &policy;
  device_ = &device;
  stats_ = &stats;
  asked_.clear();
  kept_.clear();
  hidden_.clear();
  urgent_.clear();
  settled_ = kept_asked_ = 0;
}

void Questions::ask(const AskedNode& n, bool was_visible) {
  switch (policy_->asking()) {
    case Asking::singly:
      return ask_singly(n);
    case Asking::by_rounds:
      return kept_.push_back(n);
    case Asking::late:
      if (was_visible) return kept_.push_back(n);
      return urgent_.push({scene_->view_of(n.ref).distance(scene_->node(n.ref).box), n.ref, 0});
    case Asking::by_groups:
      if (was_visible) return kept_.push_back(n);
      hidden_.push_back(n.ref);
      if (hidden_.size() >= most_hidden) ask_groups();
  }
}

void Questions::ask_singly(const AskedNode& n) {
  boxes_.clear();
  policy_->add_boxes(*scene_, n.ref, boxes_);
  asked_.push_back({.node = n, .query = device_->ask(boxes_)});
  ++stats_->queries;
}

void Questions::ask_round() {
  const bool pays = policy_->end_round(*scene_, kept_.size());
  if (pays) {
    boxes_.clear();
    for (const AskedNode& n : kept_) boxes_.push_back({n.ref.object, scene_->node(n.ref).box});
    const std::span<const std::uint32_t> counts = device_->wait(device_->ask_each(boxes_));
    for (std::size_t i = 0; i < kept_.size(); ++i) asked_.push_back({.node = kept_[i], .visible = counts[i]});
    stats_->queries += kept_.size();
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
    ++stats_->queries;
    rest = rest.subspan(size);
  }
  hidden_.clear();
}

// One of the nodes that were kept for idle moments. Whether there was any.
bool Questions::ask_kept(bool is_waiting) {
  if (!urgent_.empty()) {
    ask_singly(with_pixels(urgent_.pop().ref));
    return true;
  }
  if (!is_waiting || kept_asked_ == kept_.size()) return false;
  ask_singly(kept_[kept_asked_++]);
  return true;
}

// Hidden together, or asked about one by one.
void Questions::settle_group() {
  const std::size_t size = asked_[settled_].group;
  if (device_->wait(asked_[settled_].query)[0] == 0) {
    for (std::size_t i = settled_; i < settled_ + size; ++i) asked_[i].is_known = true;
    return;
  }
  ++stats_->wasted_queries;
  for (std::size_t i = settled_; i < settled_ + size; ++i) ask_singly(with_pixels(asked_[i].node.ref));
  settled_ += size;
}

// Nobody waits for an answer about what is below a hidden node.
bool Questions::is_gone(const Question& question) const { return scene_->state(question.node.ref).gone; }

bool Questions::is_answered(const Question& question) {
  return question.is_known || is_gone(question) || asked_.size() - settled_ >= policy_->most_asked() ||
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
  if (kept_asked_ == kept_.size()) return false;
  ask_singly(kept_[kept_asked_++]);
  return true;
}

}  // namespace occlod::hlod
