#include "examples.h"

#include <array>

namespace occlod::viewer {
namespace {

constexpr std::array<Example, 4> all = {
    {{"planet", "Rough planet", "A planet from a little above its ground: hills hide what lies behind them"},
     {"city", "City", "A street from the height of a person's eye: every house hides those behind it"},
     {"plant", "Plant", "Rooms full of pipes: walls hide them, and pipes hide each other"},
     {"city-hlod", "City as HLOD",
      "The same street as nodes that are drawn or replaced as a whole: levels of detail for the GPU", LoadAs::hlod}}};

struct Lens {
  glm::dvec3 up;
  double near;
  double far;
};

Camera looking(const glm::dvec3& eye, const glm::dvec3& target, const Lens& lens) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.up = lens.up;
  camera.fov_y_deg = 60.0;
  camera.near = lens.near;
  camera.far = lens.far;
  return camera;
}

// The scene begins where its path does.
SceneDescription scene(GeneratedMesh mesh, CameraPath path, const char* path_name) {
  SceneDescription scene;
  scene.objects.push_back({std::move(mesh)});
  scene.cameras["default"] = path.keys.front();
  scene.paths[path_name] = std::move(path);
  return scene;
}

SceneDescription planet() {
  const Lens lens{{0.0, 1.0, 0.0}, 0.005, 10.0};
  return scene({"rough-planet", {{"level", 8}}},
               {{looking({0.0, 1.35, 0.5}, {0.0, 0.95, -0.4}, lens), looking({0.45, 1.3, 0.1}, {0.1, 0.85, -0.6}, lens),
                 looking({0.65, 1.1, -0.55}, {-0.1, 0.75, -0.8}, lens)},
                240},
               "flight");
}

SceneDescription city() {
  const Lens lens{{0.0, 0.0, 1.0}, 0.2, 1500.0};
  return scene({"city", {{"blocks", 12}, {"facade_cells", 10}}},
               {{looking({125.0, 361.0, 1.7}, {700.0, 360.0, 14.0}, lens),
                 looking({350.0, 360.0, 1.7}, {580.0, 360.0, 8.0}, lens),
                 looking({360.0, 360.0, 1.7}, {365.0, 580.0, 8.0}, lens),
                 looking({360.0, 530.0, 1.7}, {360.0, 700.0, 8.0}, lens)},
                160},
               "walk");
}

SceneDescription plant() {
  const Lens lens{{0.0, 0.0, 1.0}, 0.05, 200.0};
  return scene(
      {"plant", {{"storeys", 2}, {"bays", 4}, {"pipes", 32}, {"bends", 32}, {"sides", 16}}},
      {{looking({1.0, 6.8, 7.2}, {6.0, 6.8, 7.2}, lens), looking({16.0, 6.8, 7.2}, {21.0, 6.8, 7.2}, lens)}, 160},
      "walk");
}

}  // namespace

std::span<const Example> examples() { return all; }

const Example* find_example(std::string_view name) {
  for (const Example& example : all)
    if (example.name == name) return &example;
  return nullptr;
}

SceneDescription scene_of(const Example& example) {
  const std::string_view name = example.name;
  SceneDescription scene = name == "planet" ? planet() : name == "plant" ? plant() : city();
  scene.name = example.label;
  scene.about = example.about;
  return scene;
}

}  // namespace occlod::viewer
