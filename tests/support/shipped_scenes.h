// The scenes that come with the project; the meshes of some do not.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "occlod/scene.h"

namespace occlod::test {

struct ShippedScene {
  std::filesystem::path folder;
  SceneDescription description;
};

[[nodiscard]] ShippedScene read_shipped_scene(const std::string& name);
// The first of its meshes that cannot be found.
[[nodiscard]] std::optional<std::string> missing_mesh(const ShippedScene& scene);
// Without the cache of hierarchies.
[[nodiscard]] std::vector<LoadedObject> load_objects(const ShippedScene& scene);

}  // namespace occlod::test

// Declares `variable` as the shipped scene `name`; skips the test, by the mesh, where one of its meshes is missing.
#define OCCLOD_READ_SCENE_OR_SKIP(variable, name)                                     \
  const occlod::test::ShippedScene variable = occlod::test::read_shipped_scene(name); \
  if (const auto missing = occlod::test::missing_mesh(variable); missing)             \
  GTEST_SKIP() << "SKIPPED: " << *missing << " is in no folder of OCCLOD_MESHES"
