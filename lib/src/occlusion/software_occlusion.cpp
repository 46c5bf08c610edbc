#include "occlod/occlusion/software_occlusion.h"

#include <cassert>
#include <optional>
#include <vector>

#include "occlod/occlusion/depth_pyramid.h"
#include "occlod/occlusion/screen_bounds.h"
#include "occlod/raster/item_buffer.h"

namespace occlod {
namespace {

class SoftwareOcclusion final : public Visibility {
 public:
  explicit SoftwareOcclusion(const SoftwareOcclusionOptions& options) : options_(options) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "software"; }

  void begin_view(const View& view, std::span<const ObjectView> objects) override {
    view_ = view;
    objects_.assign(objects.begin(), objects.end());
    occluder_drawn_ = false;
    answers_.clear();
    next_answer_ = 0;
  }

  void draw_occluder(std::span<const OccluderPart> parts) override {
    assert(view_ && next_answer_ == answers_.size());
    depth_.reset(view_->width(), view_->height());
    for (const OccluderPart& part : parts)
      draw_depth(depth_, part.positions, part.triangles, objects_[part.object].object_to_clip());
    pyramid_.build(depth_);
    occluder_drawn_ = true;
  }

  void submit(const VisibilityQuery& query) override {
    if (next_answer_ == answers_.size()) {
      answers_.clear();
      next_answer_ = 0;
    }
    answers_.push_back(visible_pixels(query));
  }

  [[nodiscard]] std::uint32_t collect() override {
    assert(next_answer_ < answers_.size());
    return answers_[next_answer_++];
  }

 private:
  [[nodiscard]] std::uint32_t visible_pixels(const VisibilityQuery& query) const {
    assert(view_ && query.object < objects_.size());
    const std::optional<ScreenBounds> bounds = screen_bounds(*view_, objects_[query.object], query);
    if (!bounds) return options_.count_pixels ? area({0, 0, view_->width(), view_->height()}) : 1;
    if (!occluder_drawn_) return options_.count_pixels ? area(bounds->rect) : (area(bounds->rect) > 0 ? 1 : 0);
    if (options_.count_pixels) return pyramid_.count_visible(bounds->rect, bounds->nearest_inverse_depth);
    return pyramid_.any_visible(bounds->rect, bounds->nearest_inverse_depth) ? 1 : 0;
  }

  static std::uint32_t area(const PixelRect& rect) {
    return static_cast<std::uint32_t>(rect.x1 - rect.x0) * static_cast<std::uint32_t>(rect.y1 - rect.y0);
  }

  SoftwareOcclusionOptions options_;
  std::optional<View> view_;
  std::vector<ObjectView> objects_;
  DepthBuffer depth_;
  DepthPyramid pyramid_;
  bool occluder_drawn_ = false;
  std::vector<std::uint32_t> answers_;  // since the queue was last empty; those before next_answer_ are collected
  std::size_t next_answer_ = 0;
};

}  // namespace

std::unique_ptr<Visibility> make_software_occlusion(const SoftwareOcclusionOptions& options) {
  return std::make_unique<SoftwareOcclusion>(options);
}

}  // namespace occlod
