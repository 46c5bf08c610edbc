// The program opens every scene that is shipped and every one of the benchmarks, but for the largest: it ends with 0,
// and each picture shows something. All in one process, one after the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iostream>
#include <string_view>
#include <variant>

#include "occlod/picture.h"
#include "occlod/scene.h"
#include "viewer/golden.h"
#include "viewer/support.h"

namespace occlod::viewer::test {
namespace {

using nlohmann::json;

// These have twelve million triangles and more: their hierarchies take minutes to build.
constexpr std::array<std::string_view, 6> too_large = {"city_one_crossing", "planets_268m",  "plant",
                                                       "vlod_city",         "vlod_city_one", "vlod_plant"};

// The first mesh that cannot be found, or nothing.
std::string missing_mesh(const std::filesystem::path& scene) {
  for (const SceneObject& object : read_scene(scene).objects) {
    const auto* const file = std::get_if<MeshFile>(&object.source);
    if (file == nullptr) continue;
    const auto is_there = [&](const std::string& name) { return !find_mesh(name, scene.parent_path()).empty(); };
    if (std::none_of(file->names.begin(), file->names.end(), is_there)) return file->names.front();
  }
  return {};
}

std::vector<std::filesystem::path> scenes_that_are_there() {
  std::vector<std::filesystem::path> scenes;
  for (const char* folder : {OCCLOD_SCENES, OCCLOD_BENCH_SCENES})
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() != ".json") continue;
      if (std::ranges::find(too_large, entry.path().stem().string()) != too_large.end()) {
        std::cout << "SKIPPED: " << entry.path().filename().string() << " is too large for tests\n";
        continue;
      }
      if (const std::string missing = missing_mesh(entry.path()); missing.empty())
        scenes.push_back(entry.path());
      else
        std::cout << "SKIPPED: " << entry.path().filename().string() << ": " << missing
                  << " is in no folder of OCCLOD_MESHES\n";
    }
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

// A picture of the background alone would pass where a scene does not open, and is none of these.
TEST(Scenes, AllOpenAndShowSomething) {
  const Folder folder;
  const std::vector<std::filesystem::path> scenes = scenes_that_are_there();
  ASSERT_GE(scenes.size(), 6U);  // those of generators need no files
  const auto picture = [&](const std::string& name) { return folder.path(name + ".png"); };
  json actions = {{{"do", "picture_size"}, {"width", 240}, {"height", 180}},
                  {{"do", "set"}, {"setting", "budget"}, {"value", 3000}},
                  {{"do", "screenshot"}, {"file", picture("nothing").string()}}};
  for (const std::filesystem::path& scene : scenes) {
    actions.push_back({{"do", "open"}, {"file", scene.string()}});
    actions.push_back({{"do", "expect"}, {"figure", "visible_triangles"}, {"at_least", 100}});
    actions.push_back({{"do", "screenshot"}, {"file", picture(scene.stem().string()).string()}});
    actions.push_back({{"do", "close_all"}});
  }
  const auto script = folder.write("script.json", {{"actions", actions}});
  const std::string command = std::string("\"") + OCCLOD_VIEW + "\" --debug-gl --script \"" + script.string() + "\"";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const Image nothing = read_png(picture("nothing"));
  for (const std::filesystem::path& scene : scenes)
    EXPECT_NE(difference(read_png(picture(scene.stem().string())), nothing), "") << scene;
}

}  // namespace
}  // namespace occlod::viewer::test
