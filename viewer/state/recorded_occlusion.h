// Looks over the shoulder of a backend: what was its last occluder?
#pragma once

#include <memory>
#include <vector>

#include "occlod/occlusion/depth_pyramid.h"
#include "occlod/refine/visibility.h"

namespace occlod::viewer {

// Passes everything on to `inner` and keeps a copy of the last occluder's triangles.
class RecordedOcclusion final : public Visibility {
 public:
  explicit RecordedOcclusion(Visibility& inner) : inner_(inner) {}

  [[nodiscard]] std::string_view name() const noexcept override { return inner_.name(); }
  [[nodiscard]] bool can_hide() const noexcept override { return inner_.can_hide(); }
  [[nodiscard]] std::size_t flight() const noexcept override { return inner_.flight(); }
  void begin_view(const View& view, std::span<const ObjectView> objects) override;
  void draw_occluder(std::span<const OccluderPart> parts) override;
  void submit(const VisibilityQuery& query) override { inner_.submit(query); }
  [[nodiscard]] std::uint32_t collect() override { return inner_.collect(); }

  // Its depth, drawn by the CPU at the view's size whatever the backend does; null when none was drawn.
  [[nodiscard]] std::shared_ptr<const DepthPyramid> depth() const;

 private:
  struct Part {
    glm::mat4 object_to_clip{1.0F};
    std::vector<glm::vec3> positions;
    std::vector<Triangle> triangles;
  };

  Visibility& inner_;
  std::vector<glm::mat4> object_to_clip_;
  int width_ = 0;
  int height_ = 0;
  std::vector<Part> parts_;
};

}  // namespace occlod::viewer
