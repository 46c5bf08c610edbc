#include <gtest/gtest.h>

#include <filesystem>

#include "occlod/scene.h"
#include "occlod/view.h"

namespace occlod {
namespace {

class ShippedScene : public ::testing::TestWithParam<const char*> {};

// Strict reading is the check: unknown keys, missing cameras and impossible views are errors. Every frame of a path is
// a view too.
TEST_P(ShippedScene, Reads) {
  const SceneDescription scene = read_scene(std::filesystem::path(OCCLOD_SCENES) / (std::string(GetParam()) + ".json"));
  EXPECT_EQ(scene.name, GetParam());
  for (const auto& [name, path] : scene.paths)
    for (int frame = 0; frame < path.frames; ++frame)
      EXPECT_NO_THROW((void)View(camera_at(path, frame))) << name << " " << frame;
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScene,
                         ::testing::Values("armadillo", "armadillo_group", "planet_full", "planet_near", "sponza",
                                           "sibenik", "city", "ww2_city", "hlod_row", "hlod_grid", "hlod_shelves",
                                           "hlod_5m", "hlod_12m", "plant", "dragon_alone", "car", "vlod_city",
                                           "vlod_city_one", "vlod_plant", "planets_268m"));

}  // namespace
}  // namespace occlod
