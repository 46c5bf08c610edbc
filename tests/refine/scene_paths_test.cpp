// Refinement from frame to frame along the camera paths of every scene.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "occlod/auto_refiner.h"
#include "occlod/visibility.h"
#include "oracle/cut_error.h"
#include "refine/refine_support.h"
#include "refine/tuning.h"
#include "support/shipped_scenes.h"

namespace occlod {
namespace {

constexpr std::size_t budget = 10'000;
constexpr int frames_of_a_path = 10;
// Errors that nobody sees are all alike.
constexpr double unseen_px = 0.1;

struct Way {
  Culling culling;
  bool occlusion;
};

class ScenePaths : public testing::TestWithParam<const char*> {
 protected:
  // Of the largest visible error over that from scratch.
  struct Ratios {
    double middle = 0.0, largest = 0.0;
  };

  // Each frame is a valid mesh within the budget.
  [[nodiscard]] Ratios follow(const CameraPath& path, const std::vector<RefineObject>& objects, const Way& way) const {
    const std::unique_ptr<Visibility> software = make_software_occlusion();
    NoOcclusion none;
    Visibility& visibility = way.occlusion ? *software : static_cast<Visibility&>(none);
    Refiner frames(objects), scratch(objects);
    RefineOptions options;
    options.budget = std::max(budget, 2 * frames.base_triangles());  // enough to have a choice
    tune(options).culling = way.culling;
    std::vector<double> ratios;
    for (int i = 0; i < frames_of_a_path; ++i) {
      SCOPED_TRACE(i);
      const View view(camera_at(path, i * std::max(1, path.frames / 120)));
      const Refinement& kept = frames.update(view, options, visibility);
      std::size_t triangles = 0;
      for (std::size_t k = 0; k < objects.size(); ++k) {
        test::expect_closed(*objects[k].hierarchy, kept.objects[k]);
        triangles += kept.objects[k].triangles.size();
        EXPECT_EQ(kept.objects[k].triangles.size(),
                  test::active_triangles(*objects[k].hierarchy, kept.objects[k].splits).size());
      }
      EXPECT_LE(triangles, options.budget);
      const double kept_px = oracle::cut_error(objects, kept, view, visibility).quadric_px;
      const double fresh_px =
          oracle::cut_error(objects, scratch.refine(view, options, visibility), view, visibility).quadric_px;
      ratios.push_back(std::max(kept_px, unseen_px) / std::max(fresh_px, unseen_px));
    }
    std::sort(ratios.begin(), ratios.end());
    return {ratios[ratios.size() / 2], ratios.back()};
  }
};

// A machine whose costs are round numbers.
Calibration round_calibration() {
  return {150.0, 600.0, 25.0, 350.0, 30.0, 60.0, 1.0, {{"software", 20.0, 0.8, 0.4, 200.0, 200.0}}};
}

// With effects chosen for each frame: valid meshes within the budget, and with the same calibration, written and read
// back, the same ones. A choice holds for a while: it changes by new looks and counts only, in few frames of a path.
void follow_with_auto(const CameraPath& path, const std::vector<RefineObject>& objects) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("occlod_scene_paths_" + std::to_string(getpid()) + ".json");
  write_calibration(file, round_calibration());
  AutoRefiner refiner(objects, round_calibration()), again(objects, read_calibration(file));
  std::filesystem::remove(file);
  RefineOptions options;
  options.budget = std::max(budget, 2 * refiner.base_triangles());
  std::optional<std::size_t> last;
  int changes = 0;
  for (int i = 0; i < frames_of_a_path; ++i) {
    SCOPED_TRACE(i);
    const View view(camera_at(path, i * std::max(1, path.frames / 120)));
    const Refinement& refinement = refiner.update(view, options);
    std::size_t triangles = 0;
    for (std::size_t k = 0; k < objects.size(); ++k) {
      test::expect_closed(*objects[k].hierarchy, refinement.objects[k]);
      triangles += refinement.objects[k].triangles.size();
      EXPECT_EQ(refinement.objects[k].triangles.size(),
                test::active_triangles(*objects[k].hierarchy, refinement.objects[k].splits).size());
    }
    EXPECT_LE(triangles, options.budget);
    EXPECT_EQ(again.update(view, options).hash(), refinement.hash());
    if (i > 0 && refiner.report().choice.backend != last) ++changes;
    last = refiner.report().choice.backend;
  }
  EXPECT_LE(changes, 2);
}

TEST_P(ScenePaths, FramesAreValidAndNoWorseThanFromScratch) {
  OCCLOD_READ_SCENE_OR_SKIP(scene, GetParam());
  const std::vector<LoadedObject> loaded = test::load_objects(scene);
  std::vector<RefineObject> objects;
  for (const LoadedObject& object : loaded)
    objects.push_back({object.hierarchy.get(), object.object_to_world, object.two_sided});
  ASSERT_FALSE(scene.description.paths.empty());
  double sum = 0.0;
  int ways = 0;
  for (const auto& [name, path] : scene.description.paths) {
    SCOPED_TRACE(name);
    follow_with_auto(path, objects);
  }
  for (const auto& [name, path] : scene.description.paths)
    for (const Culling culling : {Culling::subtree, Culling::star})
      for (const bool occlusion : {false, true}) {
        SCOPED_TRACE(name + (culling == Culling::star ? " star" : " subtree") + (occlusion ? " software" : " none"));
        const Ratios ratios = follow(path, objects, {culling, occlusion});
        // The order of equally important splits decides a little in each. Leaves pay for what they keep, which they do
        // not from scratch, so that an error may stay that is larger by the root of 1 + 2 splits: see UnseenNeeds.
        EXPECT_LE(ratios.middle, culling == Culling::star ? 1.73 : 1.2);
        // No frame shows a piece that the mesh of the frame before hid, and that is still coarse.
        if (GetParam() == std::string("city") && culling == Culling::star && occlusion) {
          EXPECT_LE(ratios.largest, 2.0);
        }
        sum += ratios.middle;
        ++ways;
      }
  EXPECT_LE(sum / ways, 1.05);
}

INSTANTIATE_TEST_SUITE_P(All, ScenePaths,
                         testing::Values("armadillo", "armadillo_group", "planet_full", "planet_near", "sponza",
                                         "sibenik", "city", "ww2_city"),
                         [](const auto& scene) { return std::string(scene.param); });

}  // namespace
}  // namespace occlod
