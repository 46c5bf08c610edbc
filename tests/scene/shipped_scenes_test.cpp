#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <variant>

#include "occlod/mesh_file.h"
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

glm::vec3 extent_of(const std::filesystem::path& file) {
  const CleanMesh read = read_mesh(file);
  glm::vec3 least = read.mesh.positions.front(), most = least;
  for (const glm::vec3& p : read.mesh.positions) {
    least = glm::min(least, p);
    most = glm::max(most, p);
  }
  return most - least;
}

// Cameras and placements are made for one size: a mesh that takes another's place must have it too, or a picture shows
// nothing. 5 % is more than decimating a scan changes.
TEST_P(ShippedScene, MeshesThatStandInForAnotherHaveItsSize) {
  const std::filesystem::path folder = OCCLOD_SCENES;
  std::map<std::filesystem::path, glm::vec3> extents;
  for (const SceneObject& object : read_scene(folder / (std::string(GetParam()) + ".json")).objects) {
    const auto* const source = std::get_if<MeshFile>(&object.source);
    if (source == nullptr || source->names.size() < 2) continue;
    for (const std::string& name : source->names)
      if (const std::filesystem::path file = find_mesh(name, folder); !file.empty() && !extents.contains(file))
        extents.emplace(file, extent_of(file));
  }
  for (const auto& [file, extent] : extents)
    for (int k = 0; k < 3; ++k) {
      const float wanted = extents.begin()->second[k];
      EXPECT_NEAR(extent[k], wanted, 0.05F * wanted) << file;
    }
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScene,
                         ::testing::Values("armadillo", "armadillo_group", "planet_full", "planet_near", "sponza",
                                           "sibenik", "city", "ww2_city", "hlod_row", "hlod_grid", "hlod_shelves",
                                           "hlod_5m", "hlod_12m", "plant", "dragon_alone", "car", "vlod_city",
                                           "vlod_city_one", "vlod_plant", "planets_268m"));

}  // namespace
}  // namespace occlod
