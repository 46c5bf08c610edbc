#include <gtest/gtest.h>

#include <array>

#include "occlod/base.h"
#include "occlod/scene.h"
#include "scene/scene_folder.h"

namespace occlod {
namespace {

using WriteScene = test::SceneFolder;

SceneDescription some_scene() {
  SceneDescription scene;
  scene.about = "two of a kind";
  scene.objects.push_back({MeshFile{{"a.ply", "b.ply"}}, glm::dmat4(1.0), true});
  scene.objects.push_back(
      {GeneratedMesh{"city", {{"blocks", 3}, {"facade_cells", 2}, {"seed", 0x1p53 - 1}}}, glm::dmat4(1.0), false});
  scene.objects.push_back(
      {GeneratedMesh{"pipes", {{"pipes", 5}, {"bends", 4}, {"sides", 3}, {"seed", 2}}}, glm::dmat4(1.0), false});
  const GeneratorValues planet = {{"level", 3}, {"seed", 2}, {"amplitude", 0.1}, {"frequency", 3.3}, {"octaves", 4}};
  scene.objects.push_back({GeneratedMesh{"rough-planet", planet}, glm::dmat4(1.0), false});
  scene.objects[1].object_to_world[3] = glm::dvec4(0.1, 1.0 / 3.0, -1e-17, 1.0);  // no short decimal
  scene.cameras["default"] = Camera{{0.1, 0.2, 1.0 / 7.0}, {0.0, 0.0, -1.0}, {0.0, 1.0, 0.0}, 33.3, 640, 480, 0.1, 9.9};
  scene.cameras["plan"] = scene.cameras["default"];
  scene.cameras["plan"].fov_y_deg = Camera().fov_y_deg;
  scene.cameras["plan"].orthographic_height = 1.0 / 3.0;
  scene.cameras["shifted"] = scene.cameras["default"];
  scene.cameras["shifted"].principal_point = {-1.0 / 3.0, 1.5};
  scene.cells = SceneCells{{{{0.1, 0.0, -1.0 / 3.0}, {1.0, 2.0, 3.0}}, {{5, 5, 5}, {5, 6, 7}}}, 16.5, 0.3, 12'345};
  scene.paths["hop"] = {{scene.cameras["default"], scene.cameras["plan"]}, 5, true};
  scene.paths["by"] = {{scene.cameras["default"], Camera{}}, 17};
  return scene;
}

// Numbers are written with as many digits as bring back the same bits.
TEST_F(WriteScene, ComesBackExactly) {
  const SceneDescription written = some_scene();
  write_scene(folder() / "scene.json", written);
  const SceneDescription read = read_scene(folder() / "scene.json");
  EXPECT_EQ(read.about, written.about);
  ASSERT_EQ(read.objects.size(), written.objects.size());
  for (std::size_t i = 0; i < read.objects.size(); ++i) {
    EXPECT_EQ(read.objects[i].object_to_world, written.objects[i].object_to_world);
    EXPECT_EQ(read.objects[i].two_sided, written.objects[i].two_sided);
    EXPECT_EQ(read.objects[i].attributes, written.objects[i].attributes);
  }
  EXPECT_EQ(std::get<MeshFile>(read.objects[0].source).names, std::get<MeshFile>(written.objects[0].source).names);
  for (std::size_t i = 1; i < read.objects.size(); ++i) {
    const auto& made = std::get<GeneratedMesh>(read.objects[i].source);
    EXPECT_EQ(made.generator, std::get<GeneratedMesh>(written.objects[i].source).generator);
    EXPECT_EQ(made.values, std::get<GeneratedMesh>(written.objects[i].source).values);
  }
  EXPECT_EQ(read.cameras, written.cameras);
  EXPECT_EQ(read.paths.at("by").keys, written.paths.at("by").keys);
  EXPECT_EQ(read.paths.at("by").frames, 17);
  EXPECT_FALSE(read.paths.at("by").jump);
  EXPECT_EQ(read.paths.at("hop").keys, written.paths.at("hop").keys);
  EXPECT_TRUE(read.paths.at("hop").jump);
  ASSERT_TRUE(read.cells);
  EXPECT_EQ(read.cells->regions, written.cells->regions);
  EXPECT_EQ(read.cells->root_cell, 16.5);
  EXPECT_EQ(read.cells->smallest_cell, 0.3);
  EXPECT_EQ(read.cells->max_triangles, 12'345U);
}

TEST_F(WriteScene, RefusesWhatCouldNotBeRead) {
  SceneDescription scene = some_scene();
  scene.cameras.clear();
  EXPECT_THROW(write_scene(folder() / "scene.json", scene), Error);
  scene = some_scene();
  scene.objects.clear();
  EXPECT_THROW(write_scene(folder() / "scene.json", scene), Error);
  EXPECT_THROW(write_scene(folder() / "nowhere" / "scene.json", some_scene()), Error);
  scene = some_scene();
  Camera opposite = Camera{};
  opposite.eye = 2.0 * opposite.target - opposite.eye;
  scene.paths["through"] = {{Camera{}, opposite}, 3};  // in the second frame the eye is on the target
  EXPECT_THROW(write_scene(folder() / "scene.json", scene), Error);
  EXPECT_FALSE(std::filesystem::exists(folder() / "scene.json"));
}

}  // namespace
}  // namespace occlod
