#include "report/coarse_occlusion.h"

#include "occlod/visibility.h"

namespace occlod::bench {
namespace {

// Shows its backend a smaller picture of the same view.
class CoarseOcclusion final : public Visibility {
 public:
  explicit CoarseOcclusion(int divisor) : divisor_(divisor), software_(make_software_occlusion()) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "coarse software"; }
  void begin_view(const View& view, std::span<const ObjectView> objects) override {
    Camera camera = view.camera();
    camera.width = (camera.width + divisor_ - 1) / divisor_;
    camera.height = (camera.height + divisor_ - 1) / divisor_;
    software_->begin_view(View(camera), objects);
  }
  void draw_occluder(std::span<const OccluderPart> parts) override { software_->draw_occluder(parts); }
  void submit(const VisibilityQuery& query) override { software_->submit(query); }
  [[nodiscard]] std::uint32_t collect() override { return software_->collect(); }
  [[nodiscard]] bool answers_many_threads() const noexcept override { return true; }
  void answer(std::span<const VisibilityQuery> queries, std::span<std::uint32_t> answers) override {
    software_->answer(queries, answers);
  }
  [[nodiscard]] bool tests_points() const noexcept override { return software_->tests_points(); }
  void find_visible_points(std::uint32_t object, std::span<const glm::vec3> points,
                           std::span<std::uint8_t> visible) override {
    software_->find_visible_points(object, points, visible);
  }

 private:
  int divisor_;
  std::unique_ptr<Visibility> software_;
};

}  // namespace

std::unique_ptr<Visibility> make_coarse_occlusion(int divisor) {
  if (divisor == 1) return make_software_occlusion();
  return std::make_unique<CoarseOcclusion>(divisor);
}

}  // namespace occlod::bench
