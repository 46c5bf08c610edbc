#include "occlod/select.h"

#include <algorithm>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/option_checker.h"
#include "hlod/draw/front_sizes.h"
#include "hlod/draw/trial.h"
#include "occlod/traverser.h"

namespace occlod::hlod {
namespace {

// Draws nothing, and finds everything visible. Strategy::vfc asks only where the mesh of a finer node is damaged.
class NoDevice final : public RenderDevice {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "none"; }
  void begin_frame(const View&, std::span<const PlacedHlod>) override {}
  void draw(const NodeDraw&) override {}
  [[nodiscard]] QueryId ask(std::span<const BoxRef>) override { return 0; }
  [[nodiscard]] QueryId ask_each(std::span<const BoxRef> boxes) override {
    counts_.resize(std::max(counts_.size(), boxes.size()), 1U);
    return 0;
  }
  [[nodiscard]] bool available(QueryId) override { return true; }
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId) override { return counts_; }
  void visit(std::size_t) override {}
  FrameTimes end_frame() override { return {}; }

 private:
  std::vector<std::uint32_t> counts_ = {1};  // as many as were asked about together
};

}  // namespace

class Selector::Impl {
 public:
  explicit Impl(std::span<const PlacedHlod> objects) : traverser_(objects) {
    Trial everything_counts;
    everything_counts.biased = false;
    traverser_.set_trial(everything_counts);
  }

  void set_transform(std::size_t object, const glm::dmat4& object_to_world) {
    traverser_.set_transform(object, object_to_world);
    last_camera_.reset();
  }

  const Selection& select(const View& view, const SelectOptions& options) {
    OptionChecker("selection options").at_least("tolerance_px", options.tolerance_px, 0.0);
    OptionChecker("selection options").at_least("slack_px", options.slack_px, 0.0);
    software_.set_slack(options.slack_px);
    if (options.budget == 0)
      tell(traverse(view, options, options.tolerance_px), options.tolerance_px);
    else
      select_within(view, options);
    return selection_;
  }

 private:
  const Frame& traverse(const View& view, const SelectOptions& options, double tolerance_px) {
    TraverseOptions traverse;
    traverse.strategy = options.occlusion ? Strategy::coh : Strategy::vfc;
    traverse.tolerance_px = tolerance_px;
    traverse.geomorph = options.geomorph;
    traverse.prefetch_frames = options.prefetch_frames;
    if (options.occlusion) return traverser_.draw_frame(view, software_, traverse);
    return traverser_.draw_frame(view, none_, traverse);
  }

  // Keeps the tolerance of the last frame where it uses the budget well. What a front has is known before it is drawn,
  // but for what is hidden: about the same share as in the last frame.
  void select_within(const View& view, const SelectOptions& options) {
    const auto budget = static_cast<double>(options.budget);
    const double least_px = options.tolerance_px;
    sizes_.assign(view, traverser_.objects(), least_px);
    const bool is_new = std::exchange(last_options_, options) != options || !last_camera_;
    const bool is_still = !is_new && last_camera_ == view.camera();
    if (is_new) rest_ = 0;
    tolerance_px_ = std::max(tolerance_px_, least_px);
    const double forecast = share_ * sizes_.at(tolerance_px_);
    const bool may_be_finer = forecast < well_used * budget && tolerance_px_ > least_px && rest_ == 0;
    if (is_new || forecast > budget) tolerance_px_ = sizes_.tolerance_px(aim * budget / share_);
    if (may_be_finer) tolerance_px_ = std::min(tolerance_px_, sizes_.tolerance_px(aim * budget / (hope * share_)));
    if (rest_ > 0 && !is_still) --rest_;

    double goal = aim * budget;
    for (int tries = 1;; ++tries) {
      const Frame& frame = traverse(view, options, tolerance_px_);
      const auto triangles = static_cast<double>(frame.stats.drawn_triangles);
      share_ = std::clamp(triangles / std::max(sizes_.at(tolerance_px_), 1.0), 1e-3, 1.0);
      if (triangles > budget && tolerance_px_ < sizes_.coarsest_px()) {
        tolerance_px_ = sizes_.tolerance_px(goal / share_, tolerance_px_);
        goal *= aim;
        rest_ = rest_frames;
        continue;
      }
      const double finer_px = sizes_.tolerance_px(goal / (hope * share_));
      const bool tries_finer = is_new && tries < 4 && rest_ == 0 && triangles < well_used * budget;
      if (!tries_finer || !(finer_px < tolerance_px_)) {
        tell(frame, tolerance_px_);
        break;
      }
      tolerance_px_ = finer_px;
    }
    last_camera_ = view.camera();
  }

  void tell(const Frame& frame, double tolerance_px) {
    selection_.nodes.clear();
    for (const DrawnNode& drawn : frame.draws) {
      const Hlod& hlod = *traverser_.objects()[drawn.object].hlod;
      hlod.require(drawn.node);
      selection_.nodes.push_back({drawn.object, drawn.node, hlod.mesh(drawn.node),
                                  std::span(frame.ranges).subspan(drawn.first_range, drawn.range_count)});
    }
    selection_.triangles = frame.stats.drawn_triangles;
    selection_.tolerance_px = tolerance_px;
    selection_.largest_error_px = frame.stats.largest_sse_px;
    selection_.hidden = frame.stats.hidden_nodes;
    selection_.missing = frame.stats.missing;
    selection_.front_hash = frame.front_hash;
  }

  Traverser traverser_;
  SoftwareDevice software_;
  NoDevice none_;
  // With a budget:
  static constexpr double aim = 0.95, well_used = 0.9;  // shares of the budget
  static constexpr double hope = 0.7;  // finer nodes hide more: share_ is so much less at a finer tolerance
  // Frames after one that had too many triangles: else a node on the edge of the budget would come and go.
  static constexpr int rest_frames = 20;
  FrontSizes sizes_;
  double tolerance_px_ = 0.0;          // of the last frame
  double share_ = 1.0;                 // of the triangles inside the frustum, those that it drew
  int rest_ = 0;                       // frames in which the tolerance does not shrink; a still view waits for ever
  std::optional<Camera> last_camera_;  // none before the first frame and after something has moved
  SelectOptions last_options_;
  Selection selection_;
};

Selector::Selector(std::span<const PlacedHlod> objects) : impl_(std::make_unique<Impl>(objects)) {}
Selector::Selector(Selector&&) noexcept = default;
Selector& Selector::operator=(Selector&&) noexcept = default;
Selector::~Selector() = default;

void Selector::set_transform(std::size_t object, const glm::dmat4& object_to_world) {
  impl_->set_transform(object, object_to_world);
}

const Selection& Selector::select(const View& view, const SelectOptions& options) {
  return impl_->select(view, options);
}

}  // namespace occlod::hlod
