// Real meshes that are not part of the project: found through OCCLOD_MESHES, skipped loudly where they are missing.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string_view>

namespace occlod::test {

// `name` relative to one of the ':'-separated folders of the environment variable OCCLOD_MESHES, the first that has it.
[[nodiscard]] std::optional<std::filesystem::path> find_test_mesh(std::string_view name);

}  // namespace occlod::test

// Declares `variable` as the path of the test mesh `name`; skips the test, by name, where there is none.
#define OCCLOD_FIND_TEST_MESH_OR_SKIP(variable, name)                                                  \
  const auto variable##_found = occlod::test::find_test_mesh(name);                                    \
  if (!variable##_found) GTEST_SKIP() << "SKIPPED: " << (name) << " is in no folder of OCCLOD_MESHES"; \
  const std::filesystem::path& variable = *variable##_found
