#include "occlod/select.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/option_checker.h"
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

// The tolerance that keeps a budget, from frame to frame. It grows within a frame until the budget is kept, and shrinks
// from one frame to the next.
class BudgetTolerance {
 public:
  // Returns the tolerance to try first.
  [[nodiscard]] double begin_frame(double least_px) {
    tolerance_px_ = std::max(tolerance_px_, least_px);
    return tolerance_px_;
  }

  // Lets the tolerance shrink at once.
  void wake() { rest_ = 0; }

  // Returns a larger one, after that one gave so many triangles for one of the budget. Their number falls with the
  // tolerance to the power of -1 to -2.
  [[nodiscard]] double grow(double excess) {
    rest_ = rest_frames;
    return tolerance_px_ = std::max(tolerance_px_, first_px) * std::max(std::pow(excess, 2.0 / 3.0), 1.1);
  }

  // Tells what share of the budget was used, the largest error that was selected, at which everything would have been
  // the same, and whether nothing has changed since the frame before.
  void end_frame(double used, double largest_px, bool is_still) {
    if (rest_ > 0)
      rest_ -= is_still ? 0 : 1;
    else if (used < 0.9)
      tolerance_px_ = std::min(tolerance_px_, largest_px) * std::max(std::pow(used, 2.0 / 3.0), 0.9);
  }

 private:
  static constexpr double first_px = 1.0 / 64.0;
  static constexpr int rest_frames = 20;  // after growing: else a node on the edge of the budget would come and go

  double tolerance_px_ = 0.0;
  int rest_ = 0;
};

bool are_roots(const Frame& frame, std::span<const PlacedHlod> objects) {
  return std::ranges::all_of(frame.draws, [&](const DrawnNode& drawn) {
    return objects[drawn.object].hlod->patches(drawn.node)[0].parent == no_id;
  });
}

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
    if (options.budget == 0) {
      tell(traverse(view, options, options.tolerance_px), options.tolerance_px);
      return selection_;
    }
    const auto budget = static_cast<double>(options.budget);
    if (std::exchange(last_options_, options) != options) tolerance_.wake();
    double tolerance_px = tolerance_.begin_frame(options.tolerance_px);
    const Frame* frame = &traverse(view, options, tolerance_px);
    while (frame->stats.drawn_triangles > options.budget && !are_roots(*frame, traverser_.objects())) {
      tolerance_px = tolerance_.grow(static_cast<double>(frame->stats.drawn_triangles) / budget);
      frame = &traverse(view, options, tolerance_px);
    }
    tolerance_.end_frame(static_cast<double>(frame->stats.drawn_triangles) / budget, frame->stats.largest_sse_px,
                         last_camera_ == view.camera());
    last_camera_ = view.camera();
    tell(*frame, tolerance_px);
    return selection_;
  }

 private:
  const Frame& traverse(const View& view, const SelectOptions& options, double tolerance_px) {
    TraverseOptions traverse;
    traverse.strategy = options.occlusion ? Strategy::coh : Strategy::vfc;
    traverse.tolerance_px = tolerance_px;
    traverse.geomorph = options.geomorph;
    if (options.occlusion) return traverser_.draw_frame(view, software_, traverse);
    return traverser_.draw_frame(view, none_, traverse);
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
  }

  Traverser traverser_;
  SoftwareDevice software_;
  NoDevice none_;
  BudgetTolerance tolerance_;
  std::optional<Camera> last_camera_;
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
