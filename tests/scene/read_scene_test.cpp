#include <glm/vec4.hpp>
#include <utility>
#include <vector>

#include "occlod/base.h"
#include "occlod/scene.h"
#include "scene/scene_folder.h"

namespace occlod {
namespace {

constexpr const char* a_camera = R"({"eye": [0, 0, 5], "target": [0, 0, 0]})";

std::string scene_text(const std::string& object, const std::string& camera = a_camera) {
  return R"({"objects": [)" + object + R"(], "cameras": {"default": )" + camera + "}}";
}

class ReadScene : public test::SceneFolder {
 protected:
  [[nodiscard]] SceneDescription read(const std::string& text) const { return read_scene(write("s.json", text)); }

  [[nodiscard]] Diagnosis mistake(const std::string& text) const {
    try {
      (void)read(text);
    } catch (const Error& error) {
      return error.diagnosis();
    }
    ADD_FAILURE() << "accepted: " << text;
    return {};
  }

  [[nodiscard]] std::string place_of_mistake(const std::string& text) const { return mistake(text).place; }

  // Where an object's placement takes a point.
  [[nodiscard]] glm::dvec3 placed(const std::string& placement, const glm::dvec3& point) const {
    const SceneDescription scene = read(scene_text(R"({"mesh": "m.ply", )" + placement + "}"));
    return glm::dvec3(scene.objects.at(0).object_to_world * glm::dvec4(point, 1.0));
  }
};

void expect_near(const glm::dvec3& a, const glm::dvec3& b) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-12) << "axis " << i;
}

TEST_F(ReadScene, TakesItsNameFromTheFile) { EXPECT_EQ(read(scene_text(R"({"mesh": "m.ply"})")).name, "s"); }

TEST_F(ReadScene, ReadsOneNameOrSeveral) {
  const SceneDescription scene =
      read(scene_text(R"({"mesh": "a.ply"}, {"mesh": ["b.ply", "c.ply"], "two_sided": true, "attributes": false})"));
  ASSERT_EQ(scene.objects.size(), 2U);
  EXPECT_EQ(std::get<MeshFile>(scene.objects[0].source).names, (std::vector<std::string>{"a.ply"}));
  EXPECT_FALSE(scene.objects[0].two_sided);
  EXPECT_TRUE(scene.objects[0].attributes);
  EXPECT_EQ(std::get<MeshFile>(scene.objects[1].source).names, (std::vector<std::string>{"b.ply", "c.ply"}));
  EXPECT_TRUE(scene.objects[1].two_sided);
  EXPECT_FALSE(scene.objects[1].attributes);
}

TEST_F(ReadScene, ReadsGeneratorsAndKeepsDefaults) {
  const SceneDescription scene = read(scene_text(
      R"({"generator": "rough-planet", "options": {"level": 3, "seed": 9007199254740991, "amplitude": 0.5}},
         {"generator": "city", "options": {"blocks": 2}}, {"generator": "pipes"}, {"generator": "plant", "options": {"bays": 3}},
         {"generator": "spheres-behind-wall", "options": {"wall_cells": 7}})"));
  const auto expect_made = [&](std::size_t object, const std::string& generator, const GeneratorValues& values) {
    const auto& made = std::get<GeneratedMesh>(scene.objects.at(object).source);
    EXPECT_EQ(made.generator, generator);
    EXPECT_EQ(made.values, values);  // what is not in them has its default
  };
  expect_made(0, "rough-planet", {{"level", 3}, {"seed", 0x1p53 - 1}, {"amplitude", 0.5}});
  expect_made(1, "city", {{"blocks", 2}});
  expect_made(2, "pipes", {});
  expect_made(3, "plant", {{"bays", 3}});
  expect_made(4, "spheres-behind-wall", {{"wall_cells", 7}});
}

// Scale 2 first: (1,0,0) -> (2,0,0); a quarter turn around z: (0,2,0); then moved by (10,0,0). Any other order ends
// elsewhere.
TEST_F(ReadScene, ScalesThenRotatesThenMoves) {
  expect_near(
      placed(R"("scale": 2, "rotation": {"axis": [0, 0, 3], "degrees": 90}, "position": [10, 0, 0])", {1, 0, 0}),
      {10, 2, 0});
}

// By columns: the fourth column is the translation, the first is where x goes.
TEST_F(ReadScene, ReadsMatricesByColumns) {
  expect_near(placed(R"("matrix": [0,2,0,0, 1,0,0,0, 0,0,1,0, 5,6,7,1])", {1, 0, 0}), {5, 8, 7});
}

TEST_F(ReadScene, ReadsCamerasAndPaths) {
  const SceneDescription scene = read(
      R"({"about": "x", "objects": [{"mesh": "m"}],
          "cameras": {"default": {"eye": [1, 2, 3], "target": [0, 0, 0], "up": [0, 0, 1], "fov_y_deg": 30, "near": 2, "far": 9,
                                  "width": 64, "height": 48}, "b": {"eye": [0, 0, 1], "target": [0, 0, 0]}},
          "paths": {"p": {"frames": 5, "keys": [{"eye": [0, 0, 1], "target": [0, 0, 0]}]}}})");
  const Camera& camera = scene.cameras.at("default");
  EXPECT_EQ(camera.eye, glm::dvec3(1, 2, 3));
  EXPECT_EQ(camera.up, glm::dvec3(0, 0, 1));
  EXPECT_EQ(camera.fov_y_deg, 30.0);
  EXPECT_EQ(std::make_pair(camera.near, camera.far), std::make_pair(2.0, 9.0));
  EXPECT_EQ(std::make_pair(camera.width, camera.height), std::make_pair(64, 48));
  EXPECT_EQ(scene.cameras.at("b").width, Camera{}.width);
  EXPECT_EQ(scene.paths.at("p").frames, 5);
  EXPECT_EQ(scene.paths.at("p").keys.size(), 1U);
  EXPECT_FALSE(scene.paths.at("p").jump);
}

TEST_F(ReadScene, ReadsPathsThatJump) {
  const auto text = [](const std::string& path) {
    return R"({"objects": [{"mesh": "m"}], "cameras": {"default": )" + std::string(a_camera) + R"(}, "paths": {"p": )" +
           path + "}}";
  };
  const std::string one = std::string("[") + a_camera + "]";
  const std::string two = std::string("[") + a_camera + ", " + a_camera + "]";
  EXPECT_TRUE(read(text(R"({"frames": 2, "jump": true, "keys": )" + two + "}")).paths.at("p").jump);
  EXPECT_FALSE(read(text(R"({"frames": 1, "jump": false, "keys": )" + two + "}")).paths.at("p").jump);
  const std::vector<std::pair<std::string, std::string>> mistakes = {
      {R"({"frames": 2, "jump": 1, "keys": )" + two + "}", "/paths/p/jump"},
      {R"({"frames": 1, "jump": true, "keys": )" + two + "}", "/paths/p/frames"},
      {R"({"frames": 2, "jump": true, "keys": )" + one + "}", "/paths/p/keys"},
  };
  for (const auto& [path, place] : mistakes) EXPECT_EQ(place_of_mistake(text(path)), place) << path;
}

// Half way from one side of the target to the other, in the third of five frames, the eye is on it.
TEST_F(ReadScene, RefusesPathsThroughTheirOwnTarget) {
  const auto text = [](const std::string& frames) {
    return R"({"objects": [{"mesh": "m"}], "cameras": {"default": )" + std::string(a_camera) +
           R"(}, "paths": {"through": {"frames": )" + frames + R"(, "keys": [)" + a_camera +
           R"(, {"eye": [0, 0, -5], "target": [0, 0, 0]}]}}})";
  };
  const Diagnosis diagnosis = mistake(text("5"));
  EXPECT_EQ(diagnosis.subject, (folder() / "s.json").string());
  EXPECT_EQ(diagnosis.place, "/paths/through");
  EXPECT_NE(diagnosis.problem.find("frame 2 of 5"), std::string::npos) << diagnosis.problem;
  EXPECT_NE(diagnosis.remedy.find("add a key"), std::string::npos) << diagnosis.remedy;
  EXPECT_EQ(read(text("4")).paths.at("through").frames, 4);
}

// Between a camera in perspective and an orthographic one there is nothing to go through.
TEST_F(ReadScene, ReadsOrthographicCameras) {
  const std::string plan = R"({"eye": [0, 0, 5], "target": [0, 0, 0], "orthographic_height": 2.5})";
  const auto text = [&](const std::string& jump, const std::string& second) {
    return R"({"objects": [{"mesh": "m"}], "cameras": {"default": )" + plan +
           R"(}, "paths": {"p": {"frames": 2, "jump": )" + jump + R"(, "keys": [)" + plan + ", " + second + "]}}}";
  };
  const SceneDescription scene = read(text("true", a_camera));
  EXPECT_EQ(scene.cameras.at("default").orthographic_height, 2.5);
  EXPECT_FALSE(scene.paths.at("p").keys[1].orthographic_height);
  EXPECT_NO_THROW((void)read(text("false", plan)));
  EXPECT_EQ(place_of_mistake(text("false", a_camera)), "/paths/p/keys");
}

TEST_F(ReadScene, NamesTheFile) {
  const Diagnosis diagnosis = mistake(scene_text(R"({"mesh": 1})"));
  EXPECT_EQ(diagnosis.subject, (folder() / "s.json").string());
}

TEST_F(ReadScene, NamesThePlaceOfTheMistake) {
  const std::vector<std::pair<std::string, std::string>> objects = {
      {R"({"mesh": 1})", "/objects/0/mesh"},
      {R"({"mesh": ""})", "/objects/0/mesh"},
      {R"({"mesh": []})", "/objects/0/mesh"},
      {R"({"mesh": ["a", 2]})", "/objects/0/mesh/1"},
      {R"({"mesh": "a", "colour": 1})", "/objects/0/colour"},
      {R"({"mesh": "a", "generator": "city"})", "/objects/0"},
      {R"({"position": [0, 0, 0]})", "/objects/0"},
      {R"({"mesh": "a"}, [])", "/objects/1"},
      {R"({"mesh": "a", "options": {}})", "/objects/0/options"},
      {R"({"generator": "village"})", "/objects/0/generator"},
      {R"({"generator": "city", "options": {"level": 3}})", "/objects/0/options/level"},
      {R"({"generator": "city", "options": {"blocks": 1.5}})", "/objects/0/options/blocks"},
      {R"({"generator": "city", "options": {"blocks": -1}})", "/objects/0/options/blocks"},
      {R"({"generator": "city", "options": {"blocks": 2147483648}})", "/objects/0/options/blocks"},
      {R"({"generator": "city", "options": {"blocks": 257}})", "/objects/0/options/blocks"},
      {R"({"generator": "city", "options": {"seed": -1}})", "/objects/0/options/seed"},
      {R"({"generator": "city", "options": {"seed": 9007199254740993}})", "/objects/0/options/seed"},
      {R"({"mesh": "a", "scale": "2"})", "/objects/0/scale"},
      {R"({"mesh": "a", "scale": 0})", "/objects/0/scale"},
      {R"({"mesh": "a", "two_sided": 1})", "/objects/0/two_sided"},
      {R"({"mesh": "a", "attributes": "no"})", "/objects/0/attributes"},
      {R"({"mesh": "a", "position": [0, 0]})", "/objects/0/position"},
      {R"({"mesh": "a", "position": [0, 0, null]})", "/objects/0/position/2"},
      {R"({"mesh": "a", "rotation": {"axis": [0, 0, 0], "degrees": 1}})", "/objects/0/rotation/axis"},
      {R"({"mesh": "a", "rotation": {"axis": [0, 0, 1]}})", "/objects/0/rotation"},
      {R"({"mesh": "a", "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0]})", "/objects/0/matrix"},
      {R"({"mesh": "a", "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,1, 0,0,0,1]})", "/objects/0/matrix"},
      {R"({"mesh": "a", "matrix": [1,0,0,0, 0,1,0,0, 0,0,0,0, 0,0,0,1]})", "/objects/0/matrix"},
      {R"({"mesh": "a", "scale": 1, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]})", "/objects/0/scale"},
  };
  for (const auto& [object, place] : objects) EXPECT_EQ(place_of_mistake(scene_text(object)), place) << object;
}

TEST_F(ReadScene, ChecksCameras) {
  const std::vector<std::pair<std::string, std::string>> cameras = {
      {R"({"eye": [0, 0, 1]})", "/cameras/default"},
      {R"({"eye": [0, 0, 1], "target": [0, 0, 1]})", "/cameras/default"},
      {R"({"eye": [0, 0, 1], "target": [0, 0, 0], "fov_y_deg": 180})", "/cameras/default"},
      {R"({"eye": [0, 0, 1], "target": [0, 0, 0], "near": 2, "far": 1})", "/cameras/default"},
      {R"({"eye": [0, 0, 1], "target": [0, 0, 0], "width": 0})", "/cameras/default/width"},
      {R"({"eye": [0, 0, 1], "target": [0, 0, 0], "orthographic_height": 0})", "/cameras/default"},
      {R"({"eye": [0, 0, 1], "target": [0, 0, 0], "orthographic_height": 1, "fov_y_deg": 45})",
       "/cameras/default/fov_y_deg"},
      {R"({"eye": [0, 0, 1], "target": [0, 0, 0], "principal_point": [1]})", "/cameras/default/principal_point"},
      {R"({"eye": [0, 0, 1], "target": [0, 0, 0], "orthographic_height": 1, "principal_point": [1, 0]})",
       "/cameras/default"},
      {R"({"eye": [0, 0, 1], "target": [0, 0, 0], "fov": 45})", "/cameras/default/fov"},
  };
  for (const auto& [camera, place] : cameras)
    EXPECT_EQ(place_of_mistake(scene_text(R"({"mesh": "a"})", camera)), place) << camera;
}

TEST_F(ReadScene, ReadsCells) {
  const auto text = [](const std::string& cells) {
    return R"({"objects": [{"mesh": "m"}], "cameras": {"default": )" + std::string(a_camera) + R"(}, "cells": )" +
           cells + "}";
  };
  EXPECT_FALSE(read(scene_text(R"({"mesh": "a"})")).cells);
  const std::string box = R"({"min": [0, 1, 2], "max": [3, 1, 4]})";  // it may be flat
  const SceneCells bare = *read(text(R"({"regions": [)" + box + "]}")).cells;
  EXPECT_EQ(bare.regions, (std::vector<CellBox>{{{0, 1, 2}, {3, 1, 4}}}));
  EXPECT_FALSE(bare.root_cell || bare.smallest_cell || bare.max_triangles);
  const SceneCells full = *read(text(R"({"regions": [)" + box + "," + box +
                                     R"(], "root_cell": 8, "smallest_cell": 8, "max_triangles": 7})"))
                               .cells;
  EXPECT_EQ(full.regions.size(), 2U);
  EXPECT_EQ(full.root_cell, 8.0);
  EXPECT_EQ(full.smallest_cell, 8.0);
  EXPECT_EQ(full.max_triangles, 7U);
  const std::vector<std::pair<std::string, std::string>> mistakes = {
      {"[]", "/cells"},
      {"{}", "/cells"},
      {R"({"regions": []})", "/cells/regions"},
      {R"({"regions": [{"min": [0, 0, 0]}]})", "/cells/regions/0"},
      {R"({"regions": [{"min": [0, 0, 0], "max": [0, 0]}]})", "/cells/regions/0/max"},
      {R"({"regions": [{"min": [0, 0, 1], "max": [0, 0, 0]}]})", "/cells/regions/0"},
      {R"({"regions": [)" + box + R"(], "root_cell": 0})", "/cells/root_cell"},
      {R"({"regions": [)" + box + R"(], "smallest_cell": -1})", "/cells/smallest_cell"},
      {R"({"regions": [)" + box + R"(], "root_cell": 2, "smallest_cell": 3})", "/cells/smallest_cell"},
      {R"({"regions": [)" + box + R"(], "max_triangles": 0})", "/cells/max_triangles"},
      {R"({"regions": [)" + box + R"(], "levels": 3})", "/cells/levels"},
  };
  for (const auto& [cells, place] : mistakes) EXPECT_EQ(place_of_mistake(text(cells)), place) << cells;
}

TEST_F(ReadScene, NeedsADefaultCameraAndAnObject) {
  EXPECT_EQ(place_of_mistake(R"({"objects": [{"mesh": "a"}], "cameras": {}})"), "/cameras");
  EXPECT_EQ(place_of_mistake(R"({"objects": [{"mesh": "a"}]})"), "/");
  EXPECT_EQ(place_of_mistake(R"({"objects": [], "cameras": {}})"), "/objects");
  EXPECT_EQ(place_of_mistake("[]"), "/");
}

// The comma is missing after line 2, so that the parser stops at the next key, on line 3.
TEST_F(ReadScene, NamesTheLineOfASyntaxError) {
  EXPECT_EQ(place_of_mistake("{\n\"objects\": []\n\"cameras\": {}\n}"), "line 3");
  EXPECT_EQ(place_of_mistake(""), "line 1");
}

TEST_F(ReadScene, RefusesNumbersOutOfRange) {
  EXPECT_NE(mistake(scene_text(R"({"mesh": "a", "scale": 1e999})")).problem.find("1e999"), std::string::npos);
}

// Equal keys in different objects are no repetition.
TEST_F(ReadScene, RefusesKeysGivenTwice) {
  EXPECT_NE(mistake(scene_text(R"({"mesh": "a", "mesh": "b"})")).problem.find("\"mesh\" appears twice"),
            std::string::npos);
  EXPECT_EQ(read(scene_text(R"({"mesh": "a"}, {"mesh": "b"})")).objects.size(), 2U);
}

TEST_F(ReadScene, NamesAFileThatIsNotThere) {
  EXPECT_THROW((void)read_scene(folder() / "none.json"), Error);
  EXPECT_THROW((void)read_scene(folder()), Error);
}

}  // namespace
}  // namespace occlod
