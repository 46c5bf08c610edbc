// A folder of its own for a test, with the environment that scenes look at pointing into it.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/kept_environment.h"

namespace occlod::test {

class SceneFolder : public ::testing::Test {
 protected:
  SceneFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "occlod-scene-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    setenv("XDG_CACHE_HOME", (folder_ / "cache").c_str(), 1);
    setenv("XDG_DATA_HOME", (folder_ / "data").c_str(), 1);
    unsetenv("OCCLOD_MESHES");
  }
  ~SceneFolder() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path write(const std::string& name, const std::string& content) const {
    const std::filesystem::path path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  KeptEnvironment environment_{"XDG_CACHE_HOME", "XDG_DATA_HOME", "OCCLOD_MESHES"};
  std::filesystem::path folder_;
};

}  // namespace occlod::test
