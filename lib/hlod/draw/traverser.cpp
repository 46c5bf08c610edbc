#include "occlod/traverser.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/option_checker.h"
#include "base/placement.h"
#include "hlod/draw/frame_scene.h"
#include "hlod/draw/policy.h"
#include "hlod/draw/query_value.h"
#include "hlod/draw/strategy_choice.h"
#include "hlod/draw/traversal.h"
#include "hlod/draw/trial.h"
#include "hlod/draw/virtual_clock.h"
#include "occlod/base.h"
#include "occlod/node_store.h"

namespace occlod::hlod {
namespace {

class Prefetcher {
 public:
  // Tells the stores of these objects, all of which have begun a frame, what is likely to be needed soon: first what is
  // missing to draw the objects from `ahead`, if given, without regard to occlusion; then the siblings of what `frame`
  // has drawn. O(nodes drawn, and inside that frustum), but at most some thousand of the latter.
  void run(std::span<const PlacedHlod> objects, const Frame& frame, const std::optional<View>& ahead,
           double tolerance_px, const Trial& trial);

 private:
  void look_ahead(const PlacedHlod& object, const View& ahead, double tolerance_px, const Trial& trial);

  std::vector<NodeId> reached_;  // scratch: each node once, in order
  std::vector<bool> marks_;      // per node, whether it is in reached_; all false between calls
};

constexpr std::size_t max_reached = 4096;  // nodes of one object

// Returns the view after `frames` more frames like the one from `before` to `now`: the eye moves on along a line, and
// the line of sight turns on. Returns nothing when the camera stands still, or would end where it makes no image.
[[nodiscard]] std::optional<View> view_ahead(const Camera& before, const View& now, int frames) {
  Camera camera = now.camera();
  const glm::dvec3 last = before.target - before.eye, sight = camera.target - camera.eye;
  const double length = glm::length(sight);
  const glm::dvec3 motion = camera.eye - before.eye, turn = sight / length - last / glm::length(last);
  if (frames == 0 || (motion == glm::dvec3(0.0) && turn == glm::dvec3(0.0))) return std::nullopt;
  camera.eye += static_cast<double>(frames) * motion;
  const glm::dvec3 turned = sight / length + static_cast<double>(frames) * turn;
  camera.target = camera.eye + length / glm::length(turned) * turned;
  try {
    return View(camera);
  } catch (const Error&) {
    return std::nullopt;
  }
}

void Prefetcher::run(std::span<const PlacedHlod> objects, const Frame& frame, const std::optional<View>& ahead,
                     double tolerance_px, const Trial& trial) {
  for (const PlacedHlod& object : objects)
    if (object.hlod->store() != nullptr && ahead) look_ahead(object, *ahead, tolerance_px, trial);
  for (const DrawnNode& drawn : frame.draws) {
    const Hlod& hlod = *objects[drawn.object].hlod;
    if (hlod.store() == nullptr) continue;
    for (const Patch& patch : hlod.patches(drawn.node)) {
      if (patch.parent == no_id) continue;
      for (const NodeId sibling : hlod.children(patch.parent))
        if (!hlod.is_resident(sibling)) hlod.store()->prefetch(sibling);
    }
  }
}

// Traverses like vfc, down to meshes that are not loaded.
void Prefetcher::look_ahead(const PlacedHlod& object, const View& ahead, double tolerance_px, const Trial& trial) {
  const Hlod& hlod = *object.hlod;
  if (marks_.size() < hlod.node_count()) marks_.resize(hlod.node_count(), false);
  const ObjectFrame view(ahead, object, trial);
  reached_.assign(hlod.data().roots.begin(), hlod.data().roots.end());
  for (std::size_t i = 0; i < reached_.size() && reached_.size() < max_reached; ++i) {
    const NodeId n = reached_[i];
    const Node& node = hlod.node(n);
    if (!view.may_be_inside(node.box)) continue;
    hlod.store()->prefetch(n);
    const bool is_fine = tolerance_px > 0.0 && view.error_px(node) <= tolerance_px;
    if (is_fine || !hlod.is_resident(n)) continue;
    for (const NodeId child : hlod.children(n)) {
      if (marks_[child]) continue;
      marks_[child] = true;
      reached_.push_back(child);
    }
  }
  for (const NodeId n : reached_) marks_[n] = false;
}

// Adds up the time that a frame would take by calibrated costs, while it is drawn.
// Passes every command on to a device. Fragments are estimated from bounds, so times depend on counts and answers only.
class ModelledDevice final : public RenderDevice {
 public:
  // Must be called before begin_frame(). Both references must outlive the frame.
  void set(RenderDevice& device, const FrameScene& scene) {
    device_ = &device;
    scene_ = &scene;
  }
  // Returns the modelled time of the last frame.
  [[nodiscard]] double frame_ms() const noexcept { return clock_.times().frame_ms; }

  [[nodiscard]] std::string_view name() const noexcept override { return device_->name(); }
  void begin_frame(const View& view, std::span<const PlacedHlod> objects) override;
  void draw(const NodeDraw& draw) override;
  [[nodiscard]] QueryId ask(std::span<const BoxRef> boxes) override;
  [[nodiscard]] QueryId ask_each(std::span<const BoxRef> boxes) override;
  [[nodiscard]] bool available(QueryId query) override { return device_->available(query); }
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId query) override;
  void visit(std::size_t nodes) override;
  FrameTimes end_frame() override { return device_->end_frame(); }

 private:
  QueryId note(QueryId query, double query_ns);
  [[nodiscard]] double pixels_of(std::span<const BoxRef> boxes) const;

  RenderDevice* device_ = nullptr;
  const FrameScene* scene_ = nullptr;
  VirtualClock clock_;
  std::vector<double> ready_ns_;  // per query
};

void ModelledDevice::begin_frame(const View& view, std::span<const PlacedHlod> objects) {
  clock_.begin();
  ready_ns_.clear();
  device_->begin_frame(view, objects);
}

void ModelledDevice::draw(const NodeDraw& draw) {
  const NodeRef n{draw.object, draw.node};
  const Node& node = scene_->node(n);
  double triangles = static_cast<double>(draw.cut.size()) / 3.0;
  for (const DrawRange& range : draw.ranges) triangles += static_cast<double>(range.index_count) / 3.0;
  DrawWork work = own_work(*scene_, n, scene_->view_of(n).coverage(node.box));
  if (!draw.ranges.empty()) work.fragments *= triangles / static_cast<double>(node.triangles);
  work.triangles = triangles;
  const DeviceCosts& costs = scene_->options().costs;
  clock_.command(costs.submit_ns, draw_time_ns(costs, work));
  device_->draw(draw);
}

double ModelledDevice::pixels_of(std::span<const BoxRef> boxes) const {
  double pixels = 0.0;
  for (const BoxRef& box : boxes) {
    const ObjectFrame& view = scene_->view_of({box.object, 0});
    pixels += view.coverage(box.box) * view.pixels();
  }
  return pixels;
}

QueryId ModelledDevice::note(QueryId query, double query_ns) {
  const DeviceCosts& costs = scene_->options().costs;
  if (ready_ns_.size() <= query) ready_ns_.resize(query + std::size_t{1});
  ready_ns_[query] = clock_.command(costs.submit_ns, query_ns) + costs.readback_ns;
  return query;
}

QueryId ModelledDevice::ask(std::span<const BoxRef> boxes) {
  return note(device_->ask(boxes), query_time_ns(scene_->options().costs, pixels_of(boxes)));
}

QueryId ModelledDevice::ask_each(std::span<const BoxRef> boxes) {
  const DeviceCosts& costs = scene_->options().costs;
  return note(device_->ask_each(boxes),
              std::max(costs.batch_ns + static_cast<double>(boxes.size()) * costs.batch_item_ns,
                       pixels_of(boxes) * costs.query_fragment_ns));
}

std::span<const std::uint32_t> ModelledDevice::wait(QueryId query) {
  clock_.wait_until(ready_ns_[query]);
  return device_->wait(query);
}

void ModelledDevice::visit(std::size_t nodes) {
  clock_.work(static_cast<double>(nodes) * scene_->options().costs.visit_ns);
  device_->visit(nodes);
}

constexpr double trial_share = 0.005;    // maximal share of time for trials
constexpr std::uint32_t first_try = 16;  // frame; before it, batch is still learning what is hidden
constexpr std::uint32_t min_wait = 32, max_wait = 1024;
constexpr double clearly = 0.97;  // the other strategy is chosen if it takes this share of the time
constexpr double settling = 0.5;  // share of a new time in usual_ms_

// Batch needs some frames to learn what is hidden, which do not count; vfc need not learn.
int trial_length(Strategy strategy) { return strategy == Strategy::vfc ? 1 : 4; }

}  // namespace

std::size_t StrategyChoice::next() {
  ++frame_;
  if (next_try_ == 0) next_try_ = first_try;
  const std::size_t other = 1 - chosen_;
  if (trial_frames_ == 0 && frame_ >= next_try_) trial_frames_ = trial_length(candidates[other]);
  return trial_frames_ > 0 ? other : chosen_;
}

void StrategyChoice::note(double frame_ms) {
  if (trial_frames_ > 0) {
    if (--trial_frames_ == 0) end_trial(frame_ms);
    return;
  }
  usual_ms_ = usual_ms_ > 0.0 ? usual_ms_ + settling * (frame_ms - usual_ms_) : frame_ms;
}

void StrategyChoice::end_trial(double frame_ms) {
  const std::size_t other = 1 - chosen_;
  tried_ = frame_;
  ratio_ = usual_ms_ > 0.0 ? frame_ms / usual_ms_ : 1.0;
  if (ratio_ < clearly) {
    chosen_ = other;
    usual_ms_ = frame_ms;
    ratio_ = 1.0 / ratio_;
  }
  const double wait = trial_length(candidates[1 - chosen_]) * (ratio_ - 1.0) / trial_share;
  next_try_ = frame_ + static_cast<std::uint32_t>(std::clamp(wait, double{min_wait}, double{max_wait}));
}

void StrategyChoice::write_forecasts(std::vector<StrategyForecast>& forecasts) const {
  forecasts.clear();
  if (usual_ms_ > 0.0) forecasts.push_back({candidates[chosen_], usual_ms_, 0});
  if (tried_ > 0) forecasts.push_back({candidates[1 - chosen_], ratio_ * usual_ms_, frame_ - tried_});
}

namespace {

void check_costs(const TraverseOptions& options, const Rival* rival) {
  if (!(rival != nullptr ? rival->needs_costs : needs_costs(options.strategy))) return;
  check_device_costs("traversal options: costs", options.costs);
  if (!(options.costs.draw_ns > 0.0 && options.costs.query_ns > 0.0))
    throw Error({"traversal options", "costs", "are missing", "measure those of the device: measure_costs()"});
}

void check(const TraverseOptions& options, const Trial& trial, const RenderDevice& device) {
  const OptionChecker checker("traversal options");
  checker.at_least("tolerance_px", options.tolerance_px, 0.0);
  checker.in_range("bias.s", options.bias.s, 0.0, 1.0);
  checker.in_range("bias.t", options.bias.t, 0.0, 1.0);
  checker.in_range("prefetch_frames", options.prefetch_frames, 0, 1000);
  check_costs(options, trial.rival);
  if (options.within && options.geomorph)
    throw Error({"traversal options", "within", "does not go with geomorph", "choose one of them"});
  if (trial.rival == nullptr || !trial.rival->needs_oracle) return;
  if (trial.oracle == nullptr)
    throw Error({"traversal options", "oracle", "is missing", "give the strategy a device of its own to ask"});
  if (trial.oracle == &device)
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

// Records what is known of nodes at the end of the frame, without queries that did not pay off.
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

// Removes what belongs to the oracle.
void forget_questions(Frame& frame) {
  frame.asked.clear();
  for (DrawnNode& drawn : frame.draws) drawn.asked = drawn.delayed = drawn.refined = false;
  FrameStats& stats = frame.stats;
  stats.delayed = stats.queries = stats.wasted_queries = stats.hidden_nodes = 0;
}

}  // namespace

bool needs_costs(Strategy strategy) noexcept {
  return strategy == Strategy::nohc || strategy == Strategy::batch || strategy == Strategy::automatic;
}

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

  void set_trial(const Trial& trial) {
    if (trial.rival != trial_.rival) reset();
    trial_ = trial;
  }

  const Frame& draw_frame(const View& view, RenderDevice& device, const TraverseOptions& options) {
    check(options, trial_, device);
    if (broken_off_ || options.strategy != strategy_) reset();
    strategy_ = options.strategy;
    broken_off_ = true;  // until the end is reached
    clear(frame_);
    for (NodeStore* const store : stores_) store->begin_frame();
    if (options.strategy == Strategy::automatic && trial_.rival == nullptr)
      draw_by_choice(view, device, options);
    else
      draw(way(0, options.strategy), view, device, options);
    end_stores(view, options);
    broken_off_ = false;
    return frame_;
  }

  [[nodiscard]] std::span<const PlacedHlod> objects() const noexcept { return objects_; }

 private:
  // Holds a strategy and all that it knows of nodes.
  struct Way {
    Way(std::span<const PlacedHlod> objects, Strategy by, const Rival* rival)
        : scene(objects), policy(rival != nullptr ? rival->make() : make_policy(by)), strategy(by) {}
    FrameScene scene;
    std::unique_ptr<Policy> policy;
    Strategy strategy;
  };

  Way& way(std::size_t index, Strategy strategy) {
    if (!ways_[index]) ways_[index] = std::make_unique<Way>(objects_, strategy, trial_.rival);
    return *ways_[index];
  }

  void draw(Way& way, const View& view, RenderDevice& device, const TraverseOptions& options) {
    frame_.strategy = way.strategy;
    const bool is_ideal = trial_.rival != nullptr && trial_.rival->is_ideal;
    if (Policy* const oracle = way.policy->oracle()) {
      traverse(way.scene, *oracle, view, *trial_.oracle, options);
      clear(frame_);
    }
    traverse(way.scene, *way.policy, view, is_ideal ? *trial_.oracle : device, options);
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
    scene.begin_frame(view, objects_, options, trial_, policy.biased());
    device.begin_frame(view, objects_);
    Traversal(scene, policy, device, memory_, frame_).run();
    tell(frame_, scene);
    frame_.times = device.end_frame();
  }

  // Asks the stores for what is missing, or else for what may be needed soon.
  void end_stores(const View& view, const TraverseOptions& options) {
    if (stores_.empty()) return;
    if (frame_.stats.waiting_nodes == 0 && options.prefetch_frames > 0) {
      const auto ahead =
          last_camera_ ? view_ahead(*last_camera_, view, options.prefetch_frames) : std::optional<View>();
      prefetcher_.run(objects_, frame_, ahead, options.tolerance_px, trial_);
    }
    last_camera_ = view.camera();
    for (NodeStore* const store : stores_) {
      store->end_frame();
      frame_.stats.missing += store->stats().missing;
    }
  }

  // Draws the frame again on another device, without queries.
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
  std::vector<NodeStore*> stores_;  // stores of the objects, each once
  std::optional<Camera> last_camera_;
  Prefetcher prefetcher_;
  std::array<std::unique_ptr<Way>, StrategyChoice::candidates.size()> ways_;  // only the first, except for `automatic`
  std::optional<StrategyChoice> choice_;
  ModelledDevice modelled_;
  TraversalMemory memory_;
  Frame frame_;
  Strategy strategy_ = Strategy::coh;  // in the last frame
  Trial trial_;
  bool broken_off_ = false;  // the last frame ended with an error
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

void Traverser::set_trial(const Trial& trial) { impl_->set_trial(trial); }

}  // namespace occlod::hlod
