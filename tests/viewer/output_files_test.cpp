// What a session writes overwrites nothing that it reads, and scenes name meshes so that they are found again.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "mesh_names.h"
#include "occlod/base.h"
#include "occlod/generate.h"
#include "occlod/mesh_file.h"
#include "occlod/scene.h"
#include "settings_file.h"
#include "support/kept_environment.h"
#include "viewer/support.h"

namespace occlod::viewer {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::act;

std::string content(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

class OutputFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_.path("home/meshes"));
    write_mesh(mesh_, generate("rough-planet", {{"level", 3}}));
    act(session_, {{"do", "open"}, {"file", mesh_.string()}});
    ASSERT_EQ(session_.state().objects->size(), 1U);
  }
  // What the message says; nothing is written.
  [[nodiscard]] std::string refusal(const json& action, const fs::path& file) {
    const std::string before = content(file);
    std::string told;
    try {
      act(session_, action);
    } catch (const Error& error) {
      told = error.what();
    }
    EXPECT_EQ(content(file), before) << action;
    EXPECT_EQ(told.find('\n'), std::string::npos);
    return told;
  }
  void expect_refused(const json& action, const fs::path& file, const std::string& what) {
    const std::string told = refusal(action, file);
    EXPECT_NE(told.find(what), std::string::npos) << action << told;
    EXPECT_NE(told.find("choose another name"), std::string::npos) << action << told;
  }

  const test::Folder folder_;
  const fs::path mesh_ = folder_.path("home/meshes/planet.ply");
  Session session_{test::make_portable_visibility, false};
};

TEST_F(OutputFiles, NeverAFileThatAMeshNames) {
  const fs::path mesh = folder_.path("home/square.obj"), library = folder_.path("home/square.mtl"),
                 image = folder_.path("home/skin.png");
  std::ofstream(mesh) << "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nvt 0 0\nusemtl m\n"
                         "f 1/1 2/1 3/1\nf 2/1 4/1 3/1\n";
  std::ofstream(library) << "newmtl m\nmap_Kd skin.png\n";
  std::ofstream(image) << "an image";
  act(session_, {{"do", "open"}, {"file", mesh.string()}});
  ASSERT_EQ(session_.state().objects->size(), 2U);
  for (const char* command : {"export_csv", "screenshot"}) {
    expect_refused({{"do", command}, {"file", library.string()}}, library, "is a material library of ");
    expect_refused({{"do", command}, {"file", image.string()}}, image, "is an image of ");
  }
}

TEST_F(OutputFiles, NeverTheMeshThatIsOpen) {
  const fs::path link = folder_.path("link.json");
  fs::create_symlink(mesh_, link);
  expect_refused({{"do", "save_scene"}, {"file", link.string()}}, mesh_, "the file of the open object \"planet\"");
  for (const char* command : {"export_csv", "screenshot"})
    for (const fs::path& name : {mesh_, link, folder_.path("home/../home/meshes/planet.ply")})
      expect_refused({{"do", command}, {"file", name.string()}}, mesh_, "the file of the open object \"planet\"");
  EXPECT_TRUE(session_.state().captures.empty());
  // A scene under a name that would not be opened as one.
  EXPECT_NE(refusal({{"do", "save_scene"}, {"file", mesh_.string()}}, mesh_).find("end in .json"), std::string::npos);
  // The panel says it too, and what names the remedy is no place in a script.
  session_.perform(json{{"do", "screenshot"}, {"file", mesh_.string()}});
  EXPECT_EQ(session_.state().notices.back().text,
            mesh_.string() + " is the file of the open object \"planet\" and is not overwritten; choose another name");
  // Once it is closed, it is a file like others.
  act(session_, {{"do", "close_all"}});
  session_.perform(json{{"do", "screenshot"}, {"file", mesh_.string()}});
  EXPECT_EQ(session_.state().captures.size(), 1U);
}

TEST_F(OutputFiles, FramesOfASequenceAreCheckedBeforeTheFirst) {
  const fs::path hierarchy = folder_.path("frame_00003.png");
  fs::copy(mesh_, folder_.path("copy.ply"));
  act(session_, {{"do", "open"}, {"file", folder_.path("copy.ply").string()}});
  fs::create_hard_link(folder_.path("copy.ply"), hierarchy);
  session_.state().paths["by"] = {{session_.state().camera}, 5};
  expect_refused({{"do", "picture_sequence"}, {"name", "by"}, {"folder", folder_.path("").string()}}, hierarchy,
                 "the file of the open object \"copy\"");
  EXPECT_TRUE(session_.state().playback.path.empty());
}

TEST_F(OutputFiles, NeverAnotherInputOrAnotherKindOfOutput) {
  const fs::path scene = folder_.write("scene.json", test::planet_scene(3)), script = folder_.write("script.json", {});
  session_.files().add_input(script, "the script");
  act(session_, {{"do", "open"}, {"file", scene.string()}});
  expect_refused({{"do", "export_csv"}, {"file", scene.string()}}, scene, "a scene that was opened");
  expect_refused({{"do", "save_scene"}, {"file", script.string()}}, script, "the script");
  act(session_, {{"do", "save_scene"}, {"file", scene.string()}});  // where it came from
  const fs::path numbers = folder_.path("numbers.json");
  for (int i = 0; i < 2; ++i) act(session_, {{"do", "export_csv"}, {"file", numbers.string()}});
  expect_refused({{"do", "save_scene"}, {"file", numbers.string()}}, numbers, "a table that was written before");
  expect_refused({{"do", "screenshot"}, {"file", numbers.string()}}, numbers, "a table that was written before");
}

// What stands under "objects/0/mesh" of the saved scene.
std::string saved_name(const fs::path& scene) {
  return std::get<MeshFile>(read_scene(scene).objects.at(0).source).names.at(0);
}

TEST_F(OutputFiles, SavedSceneMovesWithItsMesh) {
  for (const auto& [scene, name] :
       {std::pair("home/scene.json", "meshes/planet.ply"), std::pair("home/meshes/scene.json", "planet.ply"),
        std::pair("home/scenes/scene.json", "../meshes/planet.ply")}) {
    fs::create_directories(folder_.path(scene).parent_path());
    act(session_, {{"do", "save_scene"}, {"file", folder_.path(scene).string()}});
    EXPECT_EQ(saved_name(folder_.path(scene)), name);
    fs::rename(folder_.path("home"), folder_.path("moved"));
    Session other{test::make_portable_visibility, false};
    const std::string moved = "moved" + std::string(scene).substr(4);
    act(other, {{"do", "open"}, {"file", folder_.path(moved).string()}});
    ASSERT_EQ(other.state().objects->size(), 1U) << other.state().notices.back().text;
    EXPECT_EQ(other.state().objects->at(0).mesh->hierarchy->input_triangle_count(), 512U);  // 8 * 4^3
    // Read from elsewhere and saved here again, it is the same file.
    act(other, {{"do", "save_scene"}, {"file", folder_.path("moved/again.json").string()}});
    EXPECT_EQ(saved_name(folder_.path("moved/again.json")), "meshes/planet.ply");
    fs::rename(folder_.path("moved"), folder_.path("home"));
  }
}

// Through OCCLOD_MESHES by as much of its path as is needed; by its absolute path where nothing else leads to it.
TEST_F(OutputFiles, SavedSceneNamesMeshesInMeshFolders) {
  const fs::path elsewhere = folder_.path("scenes/deep/scene.json");
  fs::create_directories(elsewhere.parent_path());
  const auto name = [&] { return name_in_scene(mesh_, elsewhere.parent_path()); };
  const occlod::test::KeptEnvironment kept{"OCCLOD_MESHES"};
  unsetenv("OCCLOD_MESHES");
  EXPECT_EQ(name(), mesh_.string());
  setenv("OCCLOD_MESHES", folder_.path("home/meshes").c_str(), 1);
  EXPECT_EQ(name(), "planet.ply");
  setenv("OCCLOD_MESHES", folder_.path("home").c_str(), 1);
  EXPECT_EQ(name(), "meshes/planet.ply");
  // Another mesh of this name comes first.
  std::ofstream(elsewhere.parent_path() / "planet.ply") << "another";
  setenv("OCCLOD_MESHES", folder_.path("home/meshes").c_str(), 1);
  EXPECT_EQ(name(), mesh_.string());
}

TEST_F(OutputFiles, ScenesAreKnownByAnExtensionOfAnyCase) {
  act(session_, {{"do", "close_all"}});
  act(session_, {{"do", "open"}, {"file", folder_.write("Planet.JSON", test::planet_scene(3)).string()}});
  EXPECT_EQ(session_.state().errors, 0);
  EXPECT_TRUE(session_.state().bookmarks.contains("far"));
}

// A scene, say: it would be written over at the end.
TEST(SettingsFile, IsKnownByWhatItHolds) {
  const test::Folder folder;
  Session session(test::make_portable_visibility, false);
  RememberedWindow window;
  EXPECT_THROW(static_cast<void>(read_settings(folder.write("a.json", test::planet_scene()), session, window)), Error);
  const json small = {{"settings", json::object()}, {"window", {{"width", 100'000}, {"height", 900}}}};
  EXPECT_THROW(static_cast<void>(read_settings(folder.write("b.json", small), session, window)), Error);
}

}  // namespace
}  // namespace occlod::viewer
