#include "raster/software_occlusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "occlod/base.h"
#include "occlod/item_buffer.h"
#include "occlod/view.h"
#include "occlod/visibility.h"
#include "raster/depth_kernels.h"
#include "raster/depth_pyramid.h"
#include "raster/draw_bands.h"
#include "raster/screen_bounds.h"

namespace occlod {
namespace {

// Chooses powers of two by which nearness is multiplied, so that a picture can be drawn over the previous one without
// clearing it. Everything left from earlier pictures is then smaller than anything that the view shows, as if the
// pixels were empty. A power of two changes only the exponent of a number, so answers are the same as with cleared
// pictures.
class DepthEpochs {
 public:
  // Begins a picture of a view of objects; returns false when the depth image must be cleared first.
  [[nodiscard]] bool begin(const View& view, std::span<const ObjectView> objects);

  // Returns the factor by which nearness is multiplied and object_to_clip divided, which is equivalent.
  [[nodiscard]] float scale() const noexcept { return scale_; }
  // Returns scale() times a nearness that is smaller than anything in the view.
  [[nodiscard]] float least() const noexcept { return least_; }

 private:
  struct Range {
    double near, far;
    int width, height;
    friend bool operator==(const Range&, const Range&) = default;
  };
  std::optional<Range> range_;  // of the pictures since the last clear; nothing if pictures are not scaled
  int exponent_ = 0;
  float scale_ = 1.0F, least_ = 0.0F;
};

// Numbers in [2^-60, 2^60] stay in the range of floats when multiplied or divided by up to 2^60.
constexpr int max_exponent = 60;

bool is_in_range(double number) { return number == 0.0 || (std::abs(number) <= 0x1p60 && std::abs(number) >= 0x1p-60); }

bool is_in_range(const ObjectView& object) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!is_in_range(static_cast<double>(object.object_to_clip()[column][row]))) return false;
  return true;
}

bool DepthEpochs::begin(const View& view, std::span<const ObjectView> objects) {
  const Range range = {view.camera().near, view.camera().far, view.width(), view.height()};
  const bool can_scale =
      !view.is_orthographic() && range.near >= 0x1p-40 && range.far <= 0x1p40 &&
      std::all_of(objects.begin(), objects.end(), [](const ObjectView& object) { return is_in_range(object); });
  if (!can_scale) {
    range_.reset();
    scale_ = 1.0F;
    least_ = 0.0F;
    return false;
  }
  // With this step the nearest point of one picture is scaled to less than the farthest point of the next.
  const int step = static_cast<int>(std::ceil(std::log2(range.far / range.near))) + 3;
  const bool goes_on = range_ == range && exponent_ + step <= max_exponent;
  exponent_ = goes_on ? exponent_ + step : -max_exponent;
  range_ = range;
  scale_ = std::ldexp(1.0F, exponent_);
  least_ = scale_ * static_cast<float>(0.25 / range.far);
  return goes_on;
}

// Bounds of one kind and one object that are not tested yet, and the places of their answers.
template <class Shape>
struct Pending {
  std::size_t size = 0;
  std::uint32_t object = 0;
  std::array<Shape, bounds_batch_size> shapes;
  PerBound<std::uint32_t> answer;

  [[nodiscard]] VisibilityQuery query(std::size_t i) const { return {object, shapes[i]}; }
  [[nodiscard]] bool takes(std::uint32_t other_object) const {
    return size == 0 || (size < bounds_batch_size && object == other_object);
  }
};

// The sides of a picture beyond which a view may show something.
struct OpenSides {
  bool left = false, right = false, top = false, bottom = false;

  [[nodiscard]] bool any() const noexcept { return left || right || top || bottom; }
};

// Finds the sides of a picture beyond which some corner of the frustum of `view` is.
OpenSides open_sides(const View& picture, const View& view) {
  constexpr double rounding = 1e-9;
  OpenSides open;
  const glm::dmat4 clip_to_world = glm::inverse(view.world_to_clip());
  for (const double z : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double x : {-1.0, 1.0}) {
        const glm::dvec4 corner = clip_to_world * glm::dvec4(x, y, z, 1.0);
        const glm::dvec4 p = picture.world_to_clip() * (corner / corner.w);
        const double edge = p.w + rounding * std::abs(p.w);
        open.left |= !(-p.x <= edge);
        open.right |= !(p.x <= edge);
        open.top |= !(p.y <= edge);
        open.bottom |= !(-p.y <= edge);
      }
  return open;
}

class DepthOcclusion final : public SoftwareOcclusion {
 public:
  explicit DepthOcclusion(bool counts_pixels) : counts_pixels_(counts_pixels) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "software"; }
  [[nodiscard]] bool has_picture() const noexcept override { return picture_shown_; }

  void set_threads(unsigned threads) override { threads_ = threads; }

  void begin_view(const View& view, std::span<const ObjectView> objects) override {
    next_view_ = view;
    next_objects_.assign(objects.begin(), objects.end());
    if (picture_shown_ && objects_.size() == objects.size())
      open_sides_ = open_sides(*view_, view);
    else
      look_from(view, objects);
    forget_answers();
  }

  void show(const DepthBuffer& depth) override {
    if (!next_view_) throw Error({"picture", "", "is shown before the first view", "refine once before"});
    show(depth, *next_view_, next_objects_);
  }

  void show(const DepthBuffer& depth, const View& view, std::span<const ObjectView> objects) override {
    const auto size_of = [](int width, int height) { return fmt::format("{} x {} pixels", width, height); };
    if (depth.width != view.width() || depth.height != view.height())
      throw Error({"picture", "", "has " + size_of(depth.width, depth.height),
                   "its view has " + size_of(view.width(), view.height())});
    epochs_ = {};
    Camera camera = view.camera();
    if (depth.width % 2 == 0 && depth.height % 2 == 0) {
      camera.width /= 2;
      camera.height /= 2;
      pyramid_.build_halved(depth);
    } else {
      pyramid_.build(depth);
    }
    look_from(View(camera), objects);
    levels_ = pyramid_.levels();
    picture_shown_ = occluder_drawn_ = true;
  }

  void draw_occluder(std::span<const OccluderPart> parts) override {
    assert(next_view_ && next_answer_ == answers_.size());
    if (picture_shown_) look_from(*next_view_, next_objects_);
    const bool goes_on = epochs_.begin(*view_, objects_);
    set_scale(epochs_.scale(), epochs_.least());
    const DepthImage image = pyramid_.begin(view_->width(), view_->height(), !goes_on);
    parts_.clear();
    for (const OccluderPart& part : parts)
      parts_.push_back({part.positions, part.triangles, objects_[part.object].object_to_clip() / nearness_scale_, 0});
    pyramid_.finish(drawing_.draw_depth(image, parts_, threads_));
    levels_ = pyramid_.levels();
    occluder_drawn_ = true;
  }

  // Queries wait until an answer is needed, because many together cost less than one by one.
  void submit(const VisibilityQuery& query) override {
    assert(query.object < objects_.size());
    if (next_answer_ == answers_.size()) forget_answers();
    const bool waits = !std::holds_alternative<PointHull>(query.shape);  // a hull's points may be freed after the call
    if (waits) {
      waiting_.push_back(query);
      places_.push_back(answers_.size());
    }
    answers_.push_back(waits ? 0 : visible_pixels(query));
  }

  [[nodiscard]] std::uint32_t collect() override {
    assert(next_answer_ < answers_.size());
    if (!waiting_.empty() && next_answer_ >= places_.front()) answer_waiting();
    return answers_[next_answer_++];
  }

  [[nodiscard]] bool answers_many_threads() const noexcept override { return true; }

  void answer(std::span<const VisibilityQuery> queries, std::span<std::uint32_t> answers) override {
    Batches batches(*this, answers);
    for (std::size_t i = 0; i < queries.size(); ++i)
      std::visit([&](const auto& shape) { batches.add(queries[i].object, shape, static_cast<std::uint32_t>(i)); },
                 queries[i].shape);
    batches.test_all();
  }

  [[nodiscard]] bool tests_points() const noexcept override { return !counts_pixels_; }

  void find_visible_points(std::uint32_t object, std::span<const glm::vec3> points,
                           std::span<std::uint8_t> visible) override {
    if (!occluder_drawn_ || counts_pixels_) {
      Visibility::find_visible_points(object, points, visible);
      return;
    }
    PointsOutput pixels;
    for (std::size_t first = 0; first < points.size(); first += bounds_batch_size) {
      const std::size_t count = std::min(bounds_batch_size, points.size() - first);
      find_pixels(bounds_views_[object], points.subspan(first, count), pixels);
      for (std::size_t i = 0; i < count; ++i) {
        const bool shows = pyramid_.farthest(0, pixels.x[i], pixels.y[i]) <= pixels.nearness[i];
        visible[first + i] = ((pixels.on_screen[i] != 0) & shows) ? 1 : 0;
      }
    }
  }

 private:
  // Sorts the queries of one call into batches by kind and object, and tests a batch when it fills the vectors.
  class Batches {
   public:
    Batches(const DepthOcclusion& occlusion, std::span<std::uint32_t> answers)
        : occlusion_(occlusion), answers_(answers) {}

    template <class Shape>
    void add(std::uint32_t object, const Shape& shape, std::uint32_t answer) {
      if constexpr (std::is_same_v<Shape, PointHull>)
        if (shape.points.size() > max_hull_points) {
          answers_[answer] = occlusion_.visible_pixels({object, shape});
          return;
        }
      auto& batch = std::get<Pending<Shape>>(pending_);
      if (!batch.takes(object)) test(batch);
      batch.object = object;
      batch.answer[batch.size] = answer;
      batch.shapes[batch.size++] = shape;
    }
    void test_all() {
      std::apply([&](auto&... batch) { (test(batch), ...); }, pending_);
    }

   private:
    template <class Shape>
    void test(Pending<Shape>& batch);
    template <class Shape>
    void test_any(const Pending<Shape>& batch);

    // Boxes gain hardly anything from an octagon, so their diagonals are infinite.
    static Diagonals diagonals_of(const Pending<Box>& /*batch*/, std::size_t /*i*/) { return {}; }
    [[nodiscard]] Diagonals diagonals_of(const Pending<PointHull>& /*batch*/, std::size_t i) const {
      return {diagonals_.sum_low[i], diagonals_.sum_high[i], diagonals_.difference_low[i],
              diagonals_.difference_high[i]};
    }
    template <class Shape>
    [[nodiscard]] Diagonals diagonals_of(const Pending<Shape>& batch, std::size_t i) const {
      return screen_diagonals(*occlusion_.view_, occlusion_.objects_[batch.object], batch.query(i));
    }

    [[nodiscard]] PixelRect rect(std::size_t i) const {
      return {bounds_.x0[i], bounds_.y0[i], bounds_.x1[i], bounds_.y1[i]};
    }
    [[nodiscard]] std::optional<ScreenBounds> bounds(std::size_t i) const {
      if (bounds_.trusted[i] == 0) return std::nullopt;
      return ScreenBounds{rect(i), bounds_.largest_nearness[i]};
    }

    const DepthOcclusion& occlusion_;
    std::span<std::uint32_t> answers_;
    std::tuple<Pending<Sphere>, Pending<Box>, Pending<Cylinder>, Pending<PointHull>> pending_;
    BoundsOutput bounds_{};  // of the batch that is being tested
    DiagonalsOutput diagonals_;
  };

  // Looks at objects without an occluder.
  void look_from(const View& view, std::span<const ObjectView> objects) {
    view_ = view;
    objects_.assign(objects.begin(), objects.end());
    set_scale(1.0F, 0.0F);
    open_sides_ = {};
    picture_shown_ = occluder_drawn_ = false;
  }

  // Returns whether a bound may reach beyond the picture to where this view shows it.
  [[nodiscard]] bool may_be_beyond(const PixelRect& rect) const {
    if (!open_sides_.any()) return false;
    if (rect.empty()) return true;
    return (open_sides_.left && rect.x0 <= 0) || (open_sides_.right && rect.x1 >= view_->width()) ||
           (open_sides_.top && rect.y0 <= 0) || (open_sides_.bottom && rect.y1 >= view_->height());
  }

  // Sets the scale of nearness for all bounds that are computed from now on.
  void set_scale(float scale, float least) {
    nearness_scale_ = scale;
    min_nearness_ = least;
    bounds_views_.clear();
    for (const ObjectView& object : objects_) bounds_views_.emplace_back(*view_, object, scale);
  }

  void forget_answers() {
    answers_.clear();
    next_answer_ = 0;
    waiting_.clear();
    places_.clear();
  }

  void answer_waiting() {
    found_.resize(waiting_.size());
    answer(waiting_, found_);
    for (std::size_t i = 0; i < waiting_.size(); ++i) answers_[places_[i]] = found_[i];
    waiting_.clear();
    places_.clear();
  }

  [[nodiscard]] std::uint32_t visible_pixels(const VisibilityQuery& query) const {
    if (occluder_drawn_ && !counts_pixels_ && one_point_shows(query)) return 1;
    std::optional<ScreenBounds> bounds = screen_bounds(*view_, objects_[query.object], query);
    if (bounds) bounds->largest_nearness = std::max(nearness_scale_ * bounds->largest_nearness, min_nearness_);
    return visible_pixels(query, bounds);
  }

  [[nodiscard]] std::uint32_t visible_pixels(const VisibilityQuery& query,
                                             const std::optional<ScreenBounds>& bounds) const {
    if (!bounds) return counts_pixels_ ? area({0, 0, view_->width(), view_->height()}) : 1;
    if (!occluder_drawn_) return counts_pixels_ ? area(bounds->rect) : (area(bounds->rect) > 0 ? 1 : 0);
    if (may_be_beyond(bounds->rect)) return 1;
    const float nearest = bounds->largest_nearness;
    const DepthPyramid::Verdict verdict = pyramid_.quick_verdict(bounds->rect, nearest);
    if (verdict == DepthPyramid::Verdict::hidden) return 0;
    // This assumes that the middle of the rectangle is inside the outline; the error is towards visible.
    const std::uint32_t at_least = verdict == DepthPyramid::Verdict::visible ? 1 : 0;
    if (at_least != 0 && !counts_pixels_) return 1;
    const Diagonals diagonals = std::holds_alternative<Box>(query.shape)
                                    ? Diagonals{}
                                    : screen_diagonals(*view_, objects_[query.object], query);
    if (counts_pixels_) return std::max(at_least, pyramid_.count_visible(bounds->rect, nearest, diagonals));
    return pyramid_.any_visible(bounds->rect, nearest, diagonals) ? 1 : 0;
  }

  // True when one point of the bound is visible, as for most bounds. The full test would then give the same answer: the
  // bound touches the point's pixel, and its nearest point is no farther than the point.
  [[nodiscard]] bool one_point_shows(const VisibilityQuery& query) const {
    const BoundsView& view = bounds_views_[query.object];
    if (const auto* hull = std::get_if<PointHull>(&query.shape)) return shows(view, hull->points.front());
    if (const auto* box = std::get_if<Box>(&query.shape))
      return shows(view, glm::clamp(objects_[query.object].eye(), box->min, box->max));
    return false;
  }

  // True when the occluder is not nearer than p at p's pixel. False when p is not on the screen.
  [[nodiscard]] bool shows(const BoundsView& view, const glm::dvec3& p) const {
    const glm::dvec4 point(p, 1.0);
    const double w = glm::dot(view.w, point);
    if (!(w > 0.0) || !(glm::dot(view.z, point) + w >= 0.0)) return false;
    const double x = (glm::dot(view.x, point) / w * 0.5 + 0.5) * view.size.x;
    const double y = (0.5 - glm::dot(view.y, point) / w * 0.5) * view.size.y;
    if (!(x >= 0.0 && x < view.size.x && y >= 0.0 && y < view.size.y)) return false;
    const double nearness = view.orthographic ? (w - glm::dot(view.z, point)) * 0.5 : 1.0 / w;
    return pyramid_.farthest(0, static_cast<int>(x), static_cast<int>(y)) <= static_cast<float>(nearness);
  }

  static std::uint32_t area(const PixelRect& rect) {
    return static_cast<std::uint32_t>(rect.x1 - rect.x0) * static_cast<std::uint32_t>(rect.y1 - rect.y0);
  }

  bool counts_pixels_;
  std::optional<View> next_view_;         // of the last begin_view()
  std::vector<ObjectView> next_objects_;  // in it
  std::optional<View> view_;              // from which the occluder or the picture is seen
  std::vector<ObjectView> objects_;       // in it
  bool picture_shown_ = false;
  OpenSides open_sides_;  // of the picture
  std::vector<BoundsView> bounds_views_;
  DepthEpochs epochs_;
  float nearness_scale_ = 1.0F, min_nearness_ = 0.0F;  // of the current picture, see DepthEpochs
  unsigned threads_ = 1;
  raster::BandDrawing drawing_;
  std::vector<raster::DrawPart> parts_;  // scratch
  DepthPyramid pyramid_;
  DepthPyramid::Levels levels_;
  bool occluder_drawn_ = false;
  std::vector<std::uint32_t> answers_;  // since the queue was last empty; those before next_answer_ are collected
  std::size_t next_answer_ = 0;
  std::vector<VisibilityQuery> waiting_;  // queries without an answer
  std::vector<std::size_t> places_;       // places of their answers
  std::vector<std::uint32_t> found_;      // scratch
};

template <class Shape>
void DepthOcclusion::Batches::test(Pending<Shape>& batch) {
  if (batch.size == 1) {  // a vector would use a single lane
    answers_[batch.answer[0]] = occlusion_.visible_pixels(batch.query(0));
  } else if (batch.size > 1) {
    const BoundsView& view = occlusion_.bounds_views_[batch.object];
    const std::span<const Shape> shapes(batch.shapes.data(), batch.size);
    if constexpr (std::is_same_v<Shape, PointHull>)
      find_screen_bounds(view, shapes, bounds_, diagonals_);
    else
      find_screen_bounds(view, shapes, bounds_);
    for (float& nearness : bounds_.largest_nearness) nearness = std::max(nearness, occlusion_.min_nearness_);
    if (occlusion_.counts_pixels_ || !occlusion_.occluder_drawn_) {
      for (std::size_t i = 0; i < batch.size; ++i)
        answers_[batch.answer[i]] = occlusion_.visible_pixels(batch.query(i), bounds(i));
    } else {
      test_any(batch);
    }
  }
  batch.size = 0;
}

// Tests a batch: first what a few texels decide, without unpredictable branches, then the remaining bounds.
template <class Shape>
void DepthOcclusion::Batches::test_any(const Pending<Shape>& batch) {
  PerBound<std::int32_t> verdicts;
  find_quick_verdicts(occlusion_.levels_, bounds_, batch.size, verdicts);
  PerBound<std::uint8_t> open;
  std::size_t open_count = 0;
  for (std::size_t i = 0; i < batch.size; ++i) {
    const auto verdict = static_cast<DepthPyramid::Verdict>(verdicts[i]);
    const bool trusted = bounds_.trusted[i] != 0 && !occlusion_.may_be_beyond(rect(i));
    answers_[batch.answer[i]] = (!trusted | (verdict == DepthPyramid::Verdict::visible)) ? 1 : 0;
    open[open_count] = static_cast<std::uint8_t>(i);
    open_count += (trusted & (verdict == DepthPyramid::Verdict::unknown)) ? 1 : 0;
  }
  for (std::size_t k = 0; k < open_count; ++k) {
    const std::size_t i = open[k];
    const bool visible =
        occlusion_.pyramid_.search_visible(rect(i), bounds_.largest_nearness[i], diagonals_of(batch, i));
    answers_[batch.answer[i]] = visible ? 1 : 0;
  }
}

}  // namespace

std::unique_ptr<SoftwareOcclusion> make_software_occlusion() { return make_software_occlusion(false); }
std::unique_ptr<SoftwareOcclusion> make_software_occlusion(bool count_pixels) {
  return std::make_unique<DepthOcclusion>(count_pixels);
}

}  // namespace occlod
