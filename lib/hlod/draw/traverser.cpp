#include "occlod/traverse/traverser.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "base/option_checker.h"
#include "occlod/core/error.h"
#include "occlod/hlod/node_store.h"
#include "hlod/draw/modelled_device.h"
#include "hlod/draw/prefetch.h"
#include "hlod/draw/strategy_choice.h"
#include "hlod/draw/traversal.h"
#include "base/placement.h"

namespace occlod::hlod {
namespace {

void check_costs(const TraverseOptions& options) {
  if (!needs_costs(options.strategy)) return;
  check_device_costs("traversal options: costs", options.costs);
  if (!(options.costs.draw_ns > 0.0 && options.costs.query_ns > 0.0))
    throw Error({"traversal options", "costs", "are missing", "measure those of the device: measure_costs()"});
}

void check(const TraverseOptions& options, const RenderDevice& device) {
  const OptionChecker checker("traversal options");
  checker.at_least("tolerance_px", options.tolerance_px, 0.0);
  checker.in_range("bias.s", options.bias.s, 0.0, 1.0);
  checker.in_range("bias.t", options.bias.t, 0.0, 1.0);
  checker.in_range("prefetch_frames", options.prefetch_frames, 0, 1000);
  check_costs(options);
  if (options.within && options.geomorph)
    throw Error({"traversal options", "within", "does not go with geomorph", "choose one of them"});
  if (!needs_oracle(options.strategy)) return;
  if (options.oracle == nullptr)
    throw Error({"traversal options", "oracle", "is missing", "give the strategy a device of its own to ask"});
  if (options.oracle == &device)
    throw Error(
        {"traversal options", "oracle", "is the device that is drawn on", "give the strategy a second one to ask"});
}

void check(std::span<const PlacedHlod> objects) {
  if (objects.empty()) throw Error({"traverser", "", "has no objects", "give at least one HLOD"});
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::string place = "object " + std::to_string(i);
    if (objects[i].hlod == nullptr) throw Error({"traverser", place, "has no HLOD", "build one first"});
    if (objects[i].hlod->node_count() == 0)
      throw Error({"traverser", place, "has an HLOD without nodes", "build it from a mesh with triangles"});
    require_placement(objects[i].object_to_world);
  }
}

void clear(Frame& frame) {
  frame.draws.clear();
  frame.ranges.clear();
  frame.asked.clear();
  frame.stats = {};
  frame.times = {};
  frame.front_hash = 0;
  frame.forecasts.clear();
}

Answer answer_of(const NodeState& state) {
  if (!state.answered) return Answer::unread;
  if (state.hidden) return Answer::hidden;
  return state.wasted ? Answer::wasted : Answer::visible;
}

// What is known of nodes at the end of the frame. Questions that did not pay were not asked.
void tell(Frame& frame, const FrameScene& scene) {
  for (DrawnNode& drawn : frame.draws) {
    const NodeState& state = scene.state({drawn.object, drawn.node});
    drawn.bias = state.bias;
    drawn.asked = state.asked;
    drawn.delayed = state.delayed;
    drawn.blocked = state.denied;
    drawn.refined = state.status == Status::refined;
  }
  std::erase_if(frame.asked, [&](const NodeAnswer& n) { return !scene.state({n.object, n.node}).asked; });
  for (NodeAnswer& n : frame.asked) n.answer = answer_of(scene.state({n.object, n.node}));
}

// Without what its oracle did.
void forget_questions(Frame& frame) {
  frame.asked.clear();
  for (DrawnNode& drawn : frame.draws) drawn.asked = drawn.delayed = drawn.refined = false;
  FrameStats& stats = frame.stats;
  stats.delayed = stats.queries = stats.wasted_queries = stats.hidden_nodes = 0;
}

}  // namespace

bool needs_costs(Strategy strategy) noexcept {
  return strategy == Strategy::nohc || strategy == Strategy::optimum || strategy == Strategy::batch ||
         strategy == Strategy::automatic;
}

bool needs_oracle(Strategy strategy) noexcept { return strategy == Strategy::ideal || strategy == Strategy::optimum; }

class Traverser::Impl {
 public:
  explicit Impl(std::span<const PlacedHlod> objects)
      : objects_((check(objects), std::vector(objects.begin(), objects.end()))) {
    for (const PlacedHlod& object : objects_)
      if (NodeStore* const store = object.hlod->store())
        if (std::ranges::find(stores_, store) == stores_.end()) stores_.push_back(store);
  }

  void set_transform(std::size_t object, const glm::dmat4& object_to_world) {
    if (object >= objects_.size())
      throw Error({"traverser", "object " + std::to_string(object), "is not there",
                   "there are " + std::to_string(objects_.size()) + ", counted from 0"});
    require_placement(object_to_world);
    objects_[object].object_to_world = object_to_world;
  }

  void reset() {
    ways_ = {};
    choice_.reset();
  }

  const Frame& draw_frame(const View& view, RenderDevice& device, const TraverseOptions& options) {
    check(options, device);
    if (broken_off_ || options.strategy != strategy_) reset();
    strategy_ = options.strategy;
    broken_off_ = true;  // unless the end is reached
    clear(frame_);
    for (NodeStore* const store : stores_) store->begin_frame();
    if (options.strategy == Strategy::automatic)
      draw_by_choice(view, device, options);
    else
      draw(way(0, options.strategy), view, device, options);
    end_stores(view, options);
    broken_off_ = false;
    return frame_;
  }

  [[nodiscard]] std::span<const PlacedHlod> objects() const noexcept { return objects_; }

 private:
  // A strategy, and all that it knows of nodes.
  struct Way {
    Way(std::span<const PlacedHlod> objects, Strategy by) : scene(objects), policy(make_policy(by)), strategy(by) {}
    FrameScene scene;
    std::unique_ptr<Policy> policy;
    Strategy strategy;
  };

  Way& way(std::size_t index, Strategy strategy) {
    if (!ways_[index]) ways_[index] = std::make_unique<Way>(objects_, strategy);
    return *ways_[index];
  }

  void draw(Way& way, const View& view, RenderDevice& device, const TraverseOptions& options) {
    frame_.strategy = way.strategy;
    const bool is_ideal = way.strategy == Strategy::ideal;
    if (Policy* const oracle = way.policy->oracle()) {
      traverse(way.scene, *oracle, view, *options.oracle, options);
      clear(frame_);
    }
    traverse(way.scene, *way.policy, view, is_ideal ? *options.oracle : device, options);
    if (is_ideal) draw_again(view, device);
  }

  void draw_by_choice(const View& view, RenderDevice& device, const TraverseOptions& options) {
    if (!choice_) choice_.emplace();
    const std::size_t index = choice_->next();
    Way& chosen = way(index, StrategyChoice::candidates[index]);
    modelled_.set(device, chosen.scene);
    draw(chosen, view, modelled_, options);
    choice_->note(modelled_.frame_ms());
    choice_->write_forecasts(frame_.forecasts);
  }

  void traverse(FrameScene& scene, Policy& policy, const View& view, RenderDevice& device,
                const TraverseOptions& options) {
    scene.begin_frame(view, objects_, options, policy.biased());
    device.begin_frame(view, objects_);
    Traversal(scene, policy, device, memory_, frame_).run();
    tell(frame_, scene);
    frame_.times = device.end_frame();
  }

  // Asks for what is missing, or else for what may be soon.
  void end_stores(const View& view, const TraverseOptions& options) {
    if (stores_.empty()) return;
    if (frame_.stats.waiting_nodes == 0 && options.prefetch_frames > 0) {
      const auto ahead =
          last_camera_ ? view_ahead(*last_camera_, view, options.prefetch_frames) : std::optional<View>();
      prefetcher_.run(objects_, frame_, ahead, options);
    }
    last_camera_ = view.camera();
    for (NodeStore* const store : stores_) {
      store->end_frame();
      frame_.stats.missing += store->stats().missing;
    }
  }

  // What has been drawn, on another device, without a question.
  void draw_again(const View& view, RenderDevice& device) {
    device.begin_frame(view, objects_);
    const std::span<const DrawRange> ranges = frame_.ranges;
    for (const DrawnNode& drawn : frame_.draws) {
      device.visit(1);
      device.draw(
          {drawn.object, drawn.node, ranges.subspan(drawn.first_range, drawn.range_count), drawn.cut, drawn.splits});
    }
    frame_.times = device.end_frame();
    frame_.stats.visits = frame_.draws.size();
    forget_questions(frame_);
  }

  std::vector<PlacedHlod> objects_;
  std::vector<NodeStore*> stores_;  // of the objects that have one, each once
  std::optional<Camera> last_camera_;
  Prefetcher prefetcher_;
  std::array<std::unique_ptr<Way>, StrategyChoice::candidates.size()> ways_;  // the first alone, but for `automatic`
  std::optional<StrategyChoice> choice_;
  ModelledDevice modelled_;
  TraversalMemory memory_;
  Frame frame_;
  Strategy strategy_ = Strategy::coh;  // of the last frame
  bool broken_off_ = false;            // the last frame ended with an error
};

Traverser::Traverser(std::span<const PlacedHlod> objects) : impl_(std::make_unique<Impl>(objects)) {}
Traverser::Traverser(Traverser&&) noexcept = default;
Traverser& Traverser::operator=(Traverser&&) noexcept = default;
Traverser::~Traverser() = default;

void Traverser::set_transform(std::size_t object, const glm::dmat4& object_to_world) {
  impl_->set_transform(object, object_to_world);
}

void Traverser::reset() { impl_->reset(); }

const Frame& Traverser::draw_frame(const View& view, RenderDevice& device, const TraverseOptions& options) {
  return impl_->draw_frame(view, device, options);
}

std::span<const PlacedHlod> Traverser::objects() const noexcept { return impl_->objects(); }

}  // namespace occlod::hlod
