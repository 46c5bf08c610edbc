#include "occlod/occlusion/software_occlusion.h"

#include <cassert>
#include <vector>

#include "occlod/occlusion/depth_pyramid.h"
#include "occlod/raster/item_buffer.h"
#include "occlusion/bounds_batch.h"

namespace occlod {
namespace {

// Bounds of one kind and one object that are not tested yet, and where their answers belong.
template <class Shape>
struct Pending {
  std::uint32_t object = 0;
  BoundsInput bounds;
  PerBound<std::uint32_t> answer;

  [[nodiscard]] bool takes(std::uint32_t other_object) const {
    return bounds.size == 0 || (bounds.size < bounds_batch_size && object == other_object);
  }
};

// Questions are kept until a batch is full or an answer is wanted, so that many that are submitted at once cost less.
class SoftwareOcclusion final : public Visibility {
 public:
  explicit SoftwareOcclusion(const SoftwareOcclusionOptions& options) : options_(options) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "software"; }

  void begin_view(const View& view, std::span<const ObjectView> objects) override {
    width_ = view.width();
    height_ = view.height();
    objects_.clear();
    bounds_views_.clear();
    for (const ObjectView& object : objects) {
      objects_.push_back(object.object_to_clip());
      bounds_views_.emplace_back(view, object);
    }
    occluder_drawn_ = false;
    forget_answers();
  }

  void draw_occluder(std::span<const OccluderPart> parts) override {
    assert(width_ > 0 && next_answer_ == answers_.size());
    const DepthImage image = pyramid_.begin(width_, height_);
    for (const OccluderPart& part : parts) draw_depth(image, part.positions, part.triangles, objects_[part.object]);
    pyramid_.finish();
    occluder_drawn_ = true;
  }

  void submit(const VisibilityQuery& query) override {
    assert(query.object < objects_.size());
    if (next_answer_ == answers_.size()) forget_answers();
    const auto answer = static_cast<std::uint32_t>(answers_.size());
    answers_.push_back(0);
    std::visit([&](const auto& shape) { submit(query.object, shape, answer); }, query.shape);
  }

  [[nodiscard]] std::uint32_t collect() override {
    assert(next_answer_ < answers_.size());
    if (next_answer_ >= tested_) test_all();
    return answers_[next_answer_++];
  }

 private:
  void forget_answers() {
    answers_.clear();
    next_answer_ = 0;
    tested_ = 0;
    spheres_.bounds.size = boxes_.bounds.size = cylinders_.bounds.size = 0;
  }

  Pending<Sphere>& pending(const Sphere&) { return spheres_; }
  Pending<Box>& pending(const Box&) { return boxes_; }
  Pending<Cylinder>& pending(const Cylinder&) { return cylinders_; }

  template <class Shape>
  void submit(std::uint32_t object, const Shape& shape, std::uint32_t answer) {
    Pending<Shape>& batch = pending(shape);
    if (!batch.takes(object)) test(batch);
    batch.object = object;
    batch.answer[batch.bounds.size] = answer;
    batch.bounds.push(shape);
  }
  // At once: its points need not live on.
  void submit(std::uint32_t object, const PointHull& hull, std::uint32_t answer) {
    find_screen_bounds(bounds_views_[object], hull.points, found_);
    answers_[answer] = visible_pixels(0);
  }

  void test_all() {
    test(spheres_);
    test(boxes_);
    test(cylinders_);
    tested_ = answers_.size();
  }

  template <class Shape>
  void test(Pending<Shape>& batch) {
    if (batch.bounds.size == 0) return;
    find_screen_bounds<Shape>(bounds_views_[batch.object], batch.bounds, found_);
    for (std::size_t i = 0; i < batch.bounds.size; ++i) answers_[batch.answer[i]] = visible_pixels(i);
    batch.bounds.size = 0;
  }

  [[nodiscard]] std::uint32_t visible_pixels(std::size_t i) const {
    if (found_.trusted[i] == 0) return options_.count_pixels ? area({0, 0, width_, height_}) : 1;
    const PixelRect rect = {found_.x0[i], found_.y0[i], found_.x1[i], found_.y1[i]};
    if (!occluder_drawn_) return options_.count_pixels ? area(rect) : (area(rect) > 0 ? 1 : 0);
    if (options_.count_pixels) return pyramid_.count_visible(rect, found_.nearest_inverse_depth[i]);
    return pyramid_.any_visible(rect, found_.nearest_inverse_depth[i]) ? 1 : 0;
  }

  static std::uint32_t area(const PixelRect& rect) {
    return static_cast<std::uint32_t>(rect.x1 - rect.x0) * static_cast<std::uint32_t>(rect.y1 - rect.y0);
  }

  SoftwareOcclusionOptions options_;
  int width_ = 0;
  int height_ = 0;
  std::vector<glm::mat4> objects_;  // to clip space
  std::vector<BoundsView> bounds_views_;
  DepthPyramid pyramid_;
  bool occluder_drawn_ = false;
  Pending<Sphere> spheres_;
  Pending<Box> boxes_;
  Pending<Cylinder> cylinders_;
  BoundsOutput found_;
  std::vector<std::uint32_t> answers_;  // since the queue was last empty; those before next_answer_ are collected
  std::size_t next_answer_ = 0;
  std::size_t tested_ = 0;  // answers before this one are known
};

}  // namespace

std::unique_ptr<Visibility> make_software_occlusion(const SoftwareOcclusionOptions& options) {
  return std::make_unique<SoftwareOcclusion>(options);
}

}  // namespace occlod
