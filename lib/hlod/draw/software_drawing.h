// The device `software` without its interface.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/timing.h"
#include "hlod/draw/box_proxy.h"
#include "hlod/draw/morphed_positions.h"
#include "hlod/draw/node_images.h"
#include "occlod/device.h"
#include "raster/depth_image.h"
#include "raster/depth_tiles.h"

namespace occlod::hlod {

// Draws and counts for SoftwareDevice, which says how, and for simulated devices.
class SoftwareDrawing {
 public:
  explicit SoftwareDrawing(bool keep_items) : keep_items_(keep_items) {}

  void begin(const View& view, std::span<const PlacedHlod> objects) {
    watch_.begin();
    screen_ = Screen(view);
    screen_.slack_px = slack_px_;
    objects_.clear();
    for (const PlacedHlod& placed : objects) {
      const ObjectView object(view, placed.object_to_world);
      objects_.push_back({placed.hlod, object, proxy_space(screen_, view, object)});
    }
    begin_image();
    if (images_) images_->begin(image_view());
    tiles_.begin(image_);
    answers_.clear();
    work_ = {};
  }

  // From the next frame on.
  void set_slack(double pixels) noexcept { slack_px_ = pixels; }

  void draw(const NodeDraw& draw) {
    assert(draw.object < objects_.size() && draw.ranges.empty() != draw.cut.empty());
    watch_.measure([&] { images_&& draw.cut.empty() ? draw_shared(draw) : draw_alone(draw); });
  }

  // Takes what nodes look like from `images`, and adds to them what is drawn here first. Null: draws by itself. Work,
  // answers and depth are the same. Not while items are kept.
  void share_images(std::shared_ptr<NodeImages> images) {
    assert(!keep_items_);
    images_ = std::move(images);
  }

  [[nodiscard]] QueryId ask(std::span<const BoxRef> boxes) {
    assert(!boxes.empty());
    const QueryId query = answers_.begin_query();
    watch_.measure([&] {
      std::uint64_t sum = 0;
      for (const BoxRef& box : boxes) sum += count(box);
      answers_.add(static_cast<std::uint32_t>(std::min<std::uint64_t>(sum, pixels())));
    });
    return query;
  }

  [[nodiscard]] QueryId ask_each(std::span<const BoxRef> boxes) {
    const QueryId query = answers_.begin_query();
    watch_.measure([&] {
      for (const BoxRef& box : boxes) answers_.add(count(box));
    });
    return query;
  }

  [[nodiscard]] std::span<const std::uint32_t> answer(QueryId query) const { return answers_.of(query); }
  [[nodiscard]] FrameTimes end() const { return watch_.end(); }
  [[nodiscard]] const DeviceWork& work() const noexcept { return work_; }
  [[nodiscard]] const ItemBuffer& items() const noexcept { return items_; }

  [[nodiscard]] DepthBuffer depth() const {
    DepthBuffer copy;
    copy.reset(image_.width, image_.height);
    for (int y = 0; y < image_.height; ++y)
      std::copy_n(image_.nearness + y * image_.stride, image_.width,
                  copy.nearness.begin() + static_cast<std::ptrdiff_t>(y) * image_.width);
    return copy;
  }

 private:
  // Stores the counts of the queries of one frame.
  class Answers {
   public:
    void clear() {
      counts_.clear();
      first_.clear();
    }
    // Begins a query, to which the next counts are added.
    QueryId begin_query() {
      first_.push_back(counts_.size());
      return static_cast<QueryId>(first_.size() - 1);
    }
    void add(std::uint32_t count) { counts_.push_back(count); }

    [[nodiscard]] std::span<const std::uint32_t> of(QueryId query) const {
      assert(query < first_.size());
      const std::size_t first = first_[query];
      const std::size_t end = query + 1 < first_.size() ? first_[query + 1] : counts_.size();
      return std::span(counts_).subspan(first, end - first);
    }

   private:
    std::vector<std::uint32_t> counts_;
    std::vector<std::size_t> first_;  // per query, its first place in counts_
  };

  // Describes one object of a frame.
  struct DrawnObject {
    const Hlod* hlod;
    ObjectView view;
    ProxySpace space;
  };

  // Measures how long a frame's commands take.
  class Stopwatch {
   public:
    void begin() {
      start_ = Clock::now();
      first_ms_.reset();
      last_ms_ = busy_ms_ = 0.0;
    }
    template <typename Work>
    void measure(const Work& work) {
      const double before = milliseconds_since(start_);
      if (!first_ms_) first_ms_ = before;
      work();
      last_ms_ = milliseconds_since(start_);
      busy_ms_ += last_ms_ - before;
    }
    [[nodiscard]] FrameTimes end() const {
      const double frame_ms = milliseconds_since(start_);
      const double span_ms = first_ms_ ? last_ms_ - *first_ms_ : 0.0;
      return {frame_ms, frame_ms, busy_ms_, 0.0, std::max(span_ms - busy_ms_, 0.0)};
    }

   private:
    Clock::time_point start_;
    std::optional<double> first_ms_;  // begin of the first command
    double last_ms_ = 0.0;            // end of the last command
    double busy_ms_ = 0.0;
  };

  // Rows that are a multiple of this many pixels apart compete for the same cache lines, see DepthImage.
  static constexpr std::ptrdiff_t bad_stride = 1024;
  static constexpr std::ptrdiff_t padding = 16;

  void begin_image() {
    const int width = screen_.width, height = screen_.height;
    if (keep_items_) {
      items_.reset(width, height);
      image_ = {items_.depth.nearness.data(), width, height, width};
      return;
    }
    const std::ptrdiff_t stride = width % bad_stride == 0 ? width + padding : width;
    nearness_.assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(height), 0.0F);
    image_ = {nearness_.data(), width, height, stride};
  }

  [[nodiscard]] ImageView image_view() const {
    ImageView view{screen_.width, screen_.height, {}, {}};
    for (const DrawnObject& object : objects_) {
      view.hlods.push_back(object.hlod);
      view.object_to_clip.push_back(object.view.object_to_clip());
    }
    return view;
  }

  void draw_alone(const NodeDraw& draw) {
    const std::span<const glm::vec3> positions = prepare(draw);
    const glm::mat4& to_clip = objects_[draw.object].view.object_to_clip();
    const DrawnPixels drawn = keep_items_ ? draw_items_counted(items_, positions, triangles_, to_clip,
                                                               static_cast<std::uint32_t>(work_.triangles))
                                          : draw_depth_counted(image_, positions, triangles_, to_clip);
    note_drawn(drawn, triangles_.size());
  }

  void draw_shared(const NodeDraw& draw) {
    const NodeImages::Image* image = images_->find(draw);
    if (image == nullptr) {
      const std::span<const glm::vec3> positions = prepare(draw);
      const glm::mat4& to_clip = objects_[draw.object].view.object_to_clip();
      image = &images_->add(draw, triangles_.size(), [&](const DepthImage& target) {
        return draw_depth_counted(target, positions, triangles_, to_clip);
      });
    }
    images_->blend(*image, image_);
    note_drawn(image->drawn, image->triangles);
  }

  void note_drawn(const DrawnPixels& drawn, std::uint64_t triangles) {
    tiles_.change(drawn.rect);
    ++work_.draws;
    work_.triangles += triangles;
    work_.fragments += drawn.fragments;
  }

  // Fills triangles_ and returns their positions.
  [[nodiscard]] std::span<const glm::vec3> prepare(const NodeDraw& draw) {
    const Hlod& hlod = *objects_[draw.object].hlod;
    const std::span<const glm::vec3> positions = draw.cut.empty()
                                                     ? morphed_positions(hlod, draw.node, draw.ranges, positions_)
                                                     : cut_positions(hlod, draw.node, positions_);
    triangles_.clear();
    add_triangles(draw.cut);
    const std::span<const std::uint16_t> indices = hlod.mesh(draw.node).indices;
    for (const DrawRange& range : draw.ranges) {
      assert(std::size_t{range.first_index} + range.index_count <= indices.size());
      add_triangles(indices.subspan(range.first_index, range.index_count));
    }
    return positions;
  }

  void add_triangles(std::span<const std::uint16_t> indices) {
    assert(indices.size() % 3 == 0);
    for (std::size_t i = 0; i < indices.size(); i += 3)
      triangles_.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
  }

  [[nodiscard]] std::uint32_t count(const BoxRef& box) {
    assert(box.object < objects_.size());
    ++work_.boxes;
    const BoxProxy proxy = project_box(screen_, objects_[box.object].space, box.box);
    if (proxy.kind == BoxProxy::Kind::beside) return 0;
    if (proxy.kind == BoxProxy::Kind::uncertain) return pixels();
    const raster::DepthCount counted = tiles_.count(proxy.image);
    ++work_.drawn_boxes;
    work_.query_fragments += counted.covered;
    return counted.passed;
  }

  // Returns the number of pixels of the image.
  [[nodiscard]] std::uint32_t pixels() const noexcept {
    return static_cast<std::uint32_t>(screen_.width) * static_cast<std::uint32_t>(screen_.height);
  }

  bool keep_items_;
  double slack_px_ = 0.0;
  std::shared_ptr<NodeImages> images_;
  Screen screen_;
  std::vector<DrawnObject> objects_;
  std::vector<float> nearness_;  // of image_ without items
  ItemBuffer items_;
  DepthImage image_;
  raster::DepthTiles tiles_;
  Answers answers_;
  DeviceWork work_;
  Stopwatch watch_;
  std::vector<glm::vec3> positions_;  // scratch memory
  std::vector<Triangle> triangles_;   // scratch memory
};

}  // namespace occlod::hlod
