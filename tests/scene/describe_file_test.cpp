#include "occlod/base.h"
#include "occlod/scene.h"
#include "scene/scene_folder.h"

namespace occlod {
namespace {

class DescribeFile : public test::SceneFolder {
 protected:
  [[nodiscard]] static std::string complaint(const std::filesystem::path& path) {
    try {
      (void)describe_file(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.diagnosis().subject, path.string());
      EXPECT_FALSE(error.diagnosis().remedy.empty());
      return error.diagnosis().problem;
    }
    return "accepted";
  }
};

TEST_F(DescribeFile, TellsScenesByTheirExtensionInAnyCase) {
  const std::string text =
      R"({"objects": [{"mesh": "m.ply"}], "cameras": {"default": {"eye": [0, 0, 5], "target": [0, 0, 0]}}})";
  for (const char* name : {"s.json", "s.JSON", "s.Json"}) {
    const auto path = write(name, text);
    EXPECT_TRUE(is_scene_file(path));
    const SceneDescription scene = describe_file(path);
    EXPECT_EQ(scene.name, "s");
    EXPECT_EQ(scene.file, path);
    EXPECT_EQ(scene.cameras.size(), 1U);
  }
}

TEST_F(DescribeFile, TakesOtherFilesForTheOneObject) {
  const auto path = write("statue.PLY", "ply");
  EXPECT_FALSE(is_scene_file(path));
  const SceneDescription scene = describe_file(path);
  EXPECT_EQ(scene.name, "statue");
  ASSERT_EQ(scene.objects.size(), 1U);
  EXPECT_EQ(std::get<MeshFile>(scene.objects[0].source).names, (std::vector<std::string>{path.string()}));
  EXPECT_TRUE(scene.cameras.empty());
}

TEST_F(DescribeFile, RefusesWhatIsNoFile) {
  EXPECT_EQ(complaint(folder()), "is a folder");
  std::filesystem::create_directory(folder() / "s.json");
  EXPECT_EQ(complaint(folder() / "s.json"), "is a folder");
  EXPECT_EQ(complaint(folder() / "none.ply"), "no such file");
  EXPECT_EQ(complaint("/dev/null"), "is not a regular file");
}

}  // namespace
}  // namespace occlod
