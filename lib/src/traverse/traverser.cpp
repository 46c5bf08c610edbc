#include "occlod/traverse/traverser.h"

#include <string>
#include <utility>

#include "core/option_checker.h"
#include "occlod/core/error.h"
#include "traverse/traversal.h"
#include "view/placement.h"

namespace occlod::hlod {
namespace {

void check(const TraverseOptions& options, const RenderDevice& device) {
  const OptionChecker checker("traversal options");
  checker.at_least("tolerance_px", options.tolerance_px, 0.0);
  checker.in_range("bias.s", options.bias.s, 0.0, 1.0);
  checker.in_range("bias.t", options.bias.t, 0.0, 1.0);
  if (options.strategy != Strategy::ideal) return;
  if (options.oracle == nullptr)
    throw Error({"traversal options", "oracle", "is missing", "give `ideal` a device of its own to ask"});
  if (options.oracle == &device)
    throw Error({"traversal options", "oracle", "is the device that is drawn on", "give `ideal` a second one to ask"});
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
  frame.stats = {};
  frame.times = {};
  frame.front_hash = 0;
}

}  // namespace

class Traverser::Impl {
 public:
  explicit Impl(std::span<const PlacedHlod> objects)
      : objects_((check(objects), std::vector(objects.begin(), objects.end()))), scene_(objects) {}

  void set_transform(std::size_t object, const glm::dmat4& object_to_world) {
    if (object >= objects_.size())
      throw Error({"traverser", "object " + std::to_string(object), "is not there",
                   "there are " + std::to_string(objects_.size()) + ", counted from 0"});
    require_placement(object_to_world);
    objects_[object].object_to_world = object_to_world;
  }

  void reset() { scene_.forget(); }

  const Frame& draw_frame(const View& view, RenderDevice& device, const TraverseOptions& options) {
    check(options, device);
    if (broken_off_ || !policy_ || options.strategy != strategy_) {
      scene_.forget();
      policy_ = make_policy(options.strategy);
      strategy_ = options.strategy;
    }
    broken_off_ = true;  // unless the end is reached
    clear(frame_);
    traverse(view, options.strategy == Strategy::ideal ? *options.oracle : device, options);
    if (options.strategy == Strategy::ideal) draw_again(view, device);
    broken_off_ = false;
    return frame_;
  }

  [[nodiscard]] std::span<const PlacedHlod> objects() const noexcept { return objects_; }

 private:
  void traverse(const View& view, RenderDevice& device, const TraverseOptions& options) {
    scene_.begin_frame(view, objects_, options, policy_->biased());
    device.begin_frame(view, objects_);
    Traversal(scene_, *policy_, device, memory_, frame_).run();
    for (DrawnNode& drawn : frame_.draws) drawn.bias = scene_.state({drawn.object, drawn.node}).bias;
    frame_.times = device.end_frame();
  }

  // What has been drawn, on another device, without a question.
  void draw_again(const View& view, RenderDevice& device) {
    device.begin_frame(view, objects_);
    const std::span<const DrawRange> ranges = frame_.ranges;
    for (const DrawnNode& drawn : frame_.draws) {
      device.visit(1);
      device.draw({drawn.object, drawn.node, ranges.subspan(drawn.first_range, drawn.range_count)});
    }
    frame_.times = device.end_frame();
    FrameStats& stats = frame_.stats;
    stats.visits = frame_.draws.size();
    stats.delayed = stats.queries = stats.wasted_queries = stats.hidden_nodes = 0;
  }

  std::vector<PlacedHlod> objects_;
  FrameScene scene_;
  TraversalMemory memory_;
  Frame frame_;
  std::unique_ptr<Policy> policy_;
  Strategy strategy_ = Strategy::coh;  // of the policy
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
