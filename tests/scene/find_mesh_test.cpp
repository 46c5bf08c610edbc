#include "occlod/scene.h"
#include "scene/scene_folder.h"

namespace occlod {
namespace {

using FindMesh = test::SceneFolder;

// Each file that appears lies earlier in the search than those before it, so each time it is the one to be found.
TEST_F(FindMesh, LooksBesideTheSceneThenInOcclodMeshesThenInTheUsersFolder) {
  setenv("OCCLOD_MESHES", (":" + (folder() / "first").string() + ":" + (folder() / "second").string() + ":").c_str(),
         1);
  EXPECT_EQ(find_mesh("sub/m.ply", folder() / "scene"), "");
  for (const char* place : {"data/occlod/meshes", "second", "first", "scene"}) {
    const auto path = write(std::string(place) + "/sub/m.ply", "x");
    EXPECT_EQ(find_mesh("sub/m.ply", folder() / "scene"), path);
  }
}

TEST_F(FindMesh, TakesAbsoluteNamesAsTheyAre) {
  const auto path = write("m.ply", "x");
  EXPECT_EQ(find_mesh(path.string(), "/elsewhere"), path);
}

TEST_F(FindMesh, TakesNoFolderForAMesh) {
  (void)write("scene/m.ply/inside", "x");
  EXPECT_EQ(find_mesh("m.ply", folder() / "scene"), "");
}

}  // namespace
}  // namespace occlod
