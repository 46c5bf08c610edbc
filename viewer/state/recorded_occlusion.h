// Records the last occluder of a backend.
#pragma once

#include <memory>
#include <vector>

#include "occlod/visibility.h"
#include "raster/depth_pyramid.h"

namespace occlod::viewer {

// Passes everything on to `inner` and, unless told not to, keeps a copy of the last occluder's triangles.
class RecordedOcclusion final : public Visibility {
 public:
  explicit RecordedOcclusion(Visibility& inner) : inner_(inner) {}

  [[nodiscard]] std::string_view name() const noexcept override { return inner_.name(); }
  [[nodiscard]] bool can_hide() const noexcept override { return inner_.can_hide(); }
  [[nodiscard]] std::size_t flight() const noexcept override { return inner_.flight(); }
  [[nodiscard]] bool has_picture() const noexcept override { return inner_.has_picture(); }
  void set_threads(unsigned threads) override { inner_.set_threads(threads); }
  void begin_view(const View& view, std::span<const ObjectView> objects) override;
  void draw_occluder(std::span<const OccluderPart> parts) override;
  void submit(const VisibilityQuery& query) override { inner_.submit(query); }
  [[nodiscard]] std::uint32_t collect() override { return inner_.collect(); }
  [[nodiscard]] bool answers_many_threads() const noexcept override { return inner_.answers_many_threads(); }
  void answer(std::span<const VisibilityQuery> queries, std::span<std::uint32_t> answers) override {
    inner_.answer(queries, answers);
  }
  [[nodiscard]] bool tests_points() const noexcept override { return inner_.tests_points(); }
  void find_visible_points(std::uint32_t object, std::span<const glm::vec3> points,
                           std::span<std::uint8_t> visible) override {
    inner_.find_visible_points(object, points, visible);
  }

  // Forgets the last occluder. `keeps` tells whether to keep those to come.
  void begin(bool keeps);
  [[nodiscard]] bool keeps() const noexcept { return keeps_; }
  // Returns its depth in the last view, though it may have been drawn for an earlier one that still tells what is
  // hidden. The CPU draws it at the view's size whatever the backend does. Null if there is none.
  [[nodiscard]] std::shared_ptr<const DepthPyramid> depth() const;

 private:
  struct Part {
    std::uint32_t object = 0;
    std::vector<glm::vec3> corners;  // three per triangle
  };

  Visibility& inner_;
  bool keeps_ = true;
  std::vector<glm::mat4> object_to_clip_;
  int width_ = 0;
  int height_ = 0;
  std::vector<Part> parts_;
};

}  // namespace occlod::viewer
