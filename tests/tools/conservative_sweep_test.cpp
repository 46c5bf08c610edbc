// Conservative occluders against the full input, at every pixel of random views: whatever refinement hands to a backend
// is compared, so OpenGL backends, which draw the same triangles, are covered as well.
#include <gtest/gtest.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <random>
#include <string>

#include "occlod/build_hierarchy.h"
#include "occlod/item_buffer.h"
#include "occlod/refiner.h"
#include "occlod/visibility.h"
#include "oracle/random_view.h"
#include "refine/tuning.h"
#include "support/shipped_scenes.h"

namespace occlod::tool {
namespace {

// Answers as `software` does, and counts pixels where an occluder is nearer than the input.
class CheckedOcclusion final : public Visibility {
 public:
  // Of object i, all triangles.
  CheckedOcclusion(const std::vector<RefineObject>& objects, std::vector<std::vector<Triangle>> input)
      : objects_(objects), input_(std::move(input)) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "checked"; }
  void begin_view(const View& view, std::span<const ObjectView> views) override {
    views_.assign(views.begin(), views.end());
    true_depth_.reset(view.width(), view.height());
    for (std::size_t i = 0; i < objects_.size(); ++i)
      draw_depth(true_depth_, objects_[i].hierarchy->positions(), input_[i], views_[i].object_to_clip());
    software_->begin_view(view, views);
  }
  void draw_occluder(std::span<const OccluderPart> parts) override {
    depth_.reset(true_depth_.width, true_depth_.height);
    for (const OccluderPart& part : parts)
      draw_depth(depth_, part.positions, part.triangles, views_[part.object].object_to_clip());
    for (std::size_t i = 0; i < depth_.nearness.size(); ++i) {
      covered_ += depth_.nearness[i] > 0.0F ? 1U : 0U;
      wrong_ += depth_.nearness[i] > true_depth_.nearness[i] ? 1U : 0U;
    }
    software_->draw_occluder(parts);
  }
  void submit(const VisibilityQuery& query) override { software_->submit(query); }
  [[nodiscard]] std::uint32_t collect() override { return software_->collect(); }

  // Pixels, of all occluders.
  [[nodiscard]] std::size_t covered() const { return covered_; }
  [[nodiscard]] std::size_t wrong() const { return wrong_; }

 private:
  const std::vector<RefineObject>& objects_;
  std::vector<std::vector<Triangle>> input_;
  std::unique_ptr<Visibility> software_ = make_software_occlusion();
  std::vector<ObjectView> views_;
  DepthBuffer true_depth_, depth_;
  std::size_t covered_ = 0, wrong_ = 0;
};

CheckedOcclusion checked(const std::vector<RefineObject>& objects) {
  std::vector<std::vector<Triangle>> input;
  for (const RefineObject& object : objects)
    input.push_back(triangles_of(*object.hierarchy, full_cut(*object.hierarchy)));
  return {objects, std::move(input)};
}

// With a tenth of the triangles, and coarse occluders too.
void refine_in(const View& view, const std::vector<RefineObject>& objects, CheckedOcclusion& occlusion) {
  Refiner refiner(objects);
  RefineOptions options;
  options.mode = OccluderMode::conservative;
  tune(options).occluder_splits = {30, 300, 1000, 3000};
  options.budget = std::max(refiner.base_triangles(), refiner.full_triangles() / 10);
  refiner.refine(view, options, occlusion);
}

class ConservativeSweep : public testing::TestWithParam<test::SceneKind> {};
INSTANTIATE_TEST_SUITE_P(Scenes, ConservativeSweep,
                         testing::Values(test::SceneKind::planet, test::SceneKind::pipes, test::SceneKind::city,
                                         test::SceneKind::spheres_behind_wall),
                         [](const auto& param) { return test::label(param.param); });

TEST_P(ConservativeSweep, NoOccluderIsNearerThanTheInput) {
  const TriangleMesh mesh = test::scene_mesh(GetParam());
  std::size_t covered = 0;
  for (const ErrorBound error_bound : {ErrorBound::accumulated, ErrorBound::measured})
    for (const bool two_sided : {false, true}) {
      const Hierarchy hierarchy = build_hierarchy(mesh, {.error_bound = error_bound});
      const std::vector<RefineObject> objects = {{&hierarchy, glm::dmat4(1.0), two_sided}};
      CheckedOcclusion occlusion = checked(objects);
      test::RandomShapes random(29);
      for (int i = 0; i < 20; ++i) {
        Camera camera = test::random_camera(mesh, random);
        camera.width = 332;  // no whole number of tiles
        camera.height = 245;
        refine_in(View(camera), objects, occlusion);
        refine_in(View(orthographic(camera)), objects, occlusion);
      }
      EXPECT_EQ(occlusion.wrong(), 0U) << (two_sided ? "two-sided" : "solid");
      covered += occlusion.covered();
    }
  EXPECT_GT(covered, 1000U);
}

class ConservativeSweepOfScenes : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Shipped, ConservativeSweepOfScenes,
                         testing::Values("armadillo", "armadillo_group", "sponza", "sibenik"),
                         [](const auto& param) { return param.param; });

TEST_P(ConservativeSweepOfScenes, NoOccluderIsNearerThanTheInput) {
  OCCLOD_READ_SCENE_OR_SKIP(scene, GetParam());
  const std::vector<LoadedObject> loaded = test::load_objects(scene);
  std::vector<RefineObject> objects;
  for (const LoadedObject& object : loaded)
    objects.push_back({object.hierarchy.get(), object.object_to_world, object.two_sided});
  CheckedOcclusion occlusion = checked(objects);
  std::mt19937 random(31);
  std::normal_distribution<double> normal;
  const auto anywhere = [&] { return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))); };
  for (const auto& [name, shipped] : scene.description.cameras)
    for (int i = 0; i < 6; ++i) {
      Camera camera = shipped;
      const double distance = glm::distance(camera.eye, camera.target);
      camera.width = 400;
      camera.height = 300;
      camera.up = {0.2, 0.9, 0.3};
      if (i > 0) camera.eye = camera.target + distance * anywhere();
      if (i > 3) camera.target += 0.3 * distance * anywhere();
      refine_in(View(camera), objects, occlusion);
    }
  EXPECT_EQ(occlusion.wrong(), 0U);
  EXPECT_GT(occlusion.covered(), 1000U);
}

}  // namespace
}  // namespace occlod::tool
