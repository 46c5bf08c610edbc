// Looking closely: what is exported is what is shown, paths go around, distances are those of the mesh, and what is
// clipped is not there for the mouse either.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <sstream>

#include "occlod/base.h"
#include "occlod/mesh_file.h"
#include "palette.h"
#include "viewer/support.h"

namespace occlod::viewer::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Study : public ::testing::Test {
 protected:
  Study() { session_.set_view_size({400, 300}); }
  // A square of side 2 in the plane z = 0, seen from +z by parallel rays in a picture of 4 x 3 world units.
  fs::path open_square() {
    const fs::path file = folder_.path("square.ply");
    TriangleMesh square;
    square.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    square.triangles = {{0, 1, 2}, {0, 2, 3}};
    write_mesh(file, square);
    act(session_, {{"do", "open"}, {"file", file.string()}});
    act(session_, {{"do", "camera"}, {"eye", {0, 0, 3}}, {"target", {0, 0, 0}}, {"orthographic_height", 3}});
    return file;
  }
  void open_planet() {
    act(session_, {{"do", "open"}, {"file", folder_.write("planet.json", planet_scene(5)).string()}});
    act(session_, {{"do", "go_to"}, {"name", "far"}});
  }
  std::string refusal(const json& action) {
    try {
      act(session_, action);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  Folder folder_;
  Session session_{make_portable_visibility, false};
};

TEST_F(Study, ExportsTheTrianglesThatAreShown) {
  open_planet();
  act(session_, {{"do", "set"}, {"setting", "budget"}, {"value", 1500}});
  const std::uint64_t id = session_.state().objects->at(0).id;
  act(session_, {{"do", "place"}, {"object", id}, {"position", {0.25, 0, 0}}, {"scale", 0.5}});
  for (const char* extension : {".ply", ".obj", ".glb"}) {
    const fs::path file = folder_.path(std::string("shown") + extension);
    act(session_, {{"do", "export_mesh"}, {"file", file.string()}});
    const TriangleMesh mesh = read_mesh(file).mesh;
    EXPECT_EQ(static_cast<double>(mesh.triangle_count()), session_.figures().at("triangles")) << extension;
    float right = -1e9F;
    for (const glm::vec3& p : mesh.positions) right = std::max(right, p.x + static_cast<float>(mesh.origin.x));
    EXPECT_NEAR(right, 0.75F, 0.06F) << extension;  // hills of 8 % of the radius, scaled and moved
  }
}

TEST_F(Study, ExportOverwritesNothingThatIsRead) {
  const fs::path square = open_square();
  std::ostringstream before;
  before << std::ifstream(square, std::ios::binary).rdbuf();
  EXPECT_NE(refusal({{"do", "export_mesh"}, {"file", square.string()}}).find("the file of the open object"),
            std::string::npos);
  std::ostringstream after;
  after << std::ifstream(square, std::ios::binary).rdbuf();
  EXPECT_EQ(after.str(), before.str());
  // An OBJ file has its materials beside it.
  session_.files().add_input(folder_.path("script.mtl"), "the script");
  EXPECT_NE(refusal({{"do", "export_mesh"}, {"file", folder_.path("script.obj").string()}}).find("is the script"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "export_mesh"}, {"file", folder_.path("shown.txt").string()}}).find("shown.txt"),
            std::string::npos);
  act(session_, {{"do", "close_all"}});
  EXPECT_NE(refusal({{"do", "export_mesh"}, {"file", folder_.path("a.ply").string()}}).find("nothing is shown"),
            std::string::npos);
}

// An image inside a GLB file becomes a file beside an OBJ file.
TEST_F(Study, ExportOverwritesNothingWithImages) {
  TriangleMesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  mesh.texture_coordinates = {{0, 0}, {1, 0}, {0, 1}};
  mesh.triangles = {{0, 1, 2}};
  mesh.triangle_materials = {0};
  mesh.materials.emplace_back().texture = 0;
  mesh.textures.emplace_back().mime_type = "image/png";
  mesh.textures[0].bytes = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  const fs::path glb = folder_.path("brick.glb");
  write_mesh(glb, mesh);
  act(session_, {{"do", "open"}, {"file", glb.string()}});
  act(session_, {{"do", "camera"}, {"eye", {0, 0, 3}}, {"target", {0, 0, 0}}, {"orthographic_height", 3}});
  session_.files().add_input(folder_.path("wall_0.png"), "the script");
  EXPECT_NE(refusal({{"do", "export_mesh"}, {"file", folder_.path("wall.obj").string()}}).find("is the script"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(folder_.path("wall.obj")));
  EXPECT_FALSE(fs::exists(folder_.path("wall_0.png")));
  act(session_, {{"do", "export_mesh"}, {"file", folder_.path("other.obj").string()}});
  EXPECT_TRUE(fs::exists(folder_.path("other_0.png")));
}

// Neighbouring nodes meet in the same places: their vertices become one.
TEST_F(Study, ExportsTheNodesOfAnHlodAsOneMesh) {
  act(session_, {{"do", "set"}, {"setting", "device"}, {"value", "software"}});
  act(session_, {{"do", "open"},
                 {"file", folder_.write("city.json", city_scene(write_city(folder_).filename().string())).string()}});
  const fs::path file = folder_.path("street.ply");
  act(session_, {{"do", "export_mesh"}, {"file", file.string()}});
  const TriangleMesh mesh = read_mesh(file).mesh;
  EXPECT_EQ(static_cast<double>(mesh.triangle_count()), session_.figures().at("triangles"));
  const FrontObject& front = session_.frame()->hlod_sides[0].front->objects[0];
  EXPECT_LT(mesh.vertex_count(), front.positions.size());
}

TEST_F(Study, TurntableGoesOnceAroundTheTarget) {
  open_planet();
  const Camera before = session_.state().camera;
  act(session_, {{"do", "turntable"}, {"name", "around"}, {"frames", 8}});
  const CameraPath& path = session_.state().paths.at("around");
  ASSERT_EQ(path.frames, 8);
  for (int i = 0; i < 8; ++i) {
    const Camera camera = camera_at(path, i);
    EXPECT_NEAR(glm::distance(camera.eye, before.target), glm::distance(before.eye, before.target), 1e-9);
    EXPECT_NEAR(camera.eye.y, before.eye.y, 1e-9);
  }
  EXPECT_NEAR(glm::distance(camera_at(path, 0).eye, before.eye), 0.0, 1e-9);
  const glm::dvec3 opposite(-before.eye.x, before.eye.y, -before.eye.z);
  EXPECT_NEAR(glm::distance(camera_at(path, 4).eye, opposite), 0.0, 1e-9);
  act(session_, {{"do", "save_scene"}, {"file", folder_.path("saved.json").string()}});
  EXPECT_EQ(read_scene(folder_.path("saved.json")).paths.at("around").keys.size(), 8U);
  EXPECT_NE(refusal({{"do", "turntable"}, {"frames", 1}}), "");
}

TEST_F(Study, TheFrozenCameraIsFoundAgain) {
  open_planet();
  EXPECT_NE(refusal({{"do", "to_frozen"}}).find("nothing is frozen"), std::string::npos);
  const Camera frozen = session_.state().camera;
  act(session_, {{"do", "set"}, {"setting", "freeze"}, {"value", true}});
  act(session_, {{"do", "orbit"}, {"right", 70}, {"up", 20}});
  act(session_, {{"do", "zoom"}, {"factor", 2}});
  ASSERT_NE(session_.state().camera, frozen);
  act(session_, {{"do", "to_frozen"}});
  EXPECT_EQ(session_.state().camera, frozen);
}

// The picture is 4 world units wide, so half of it is 2; a third click begins anew.
TEST_F(Study, MeasuresWorldUnits) {
  open_square();
  act(session_, {{"do", "measure"}, {"x", 0.3}, {"y", 0.5}});
  EXPECT_FALSE(session_.figures().contains("distance"));
  act(session_, {{"do", "measure"}, {"x", 0.01}, {"y", 0.5}});  // beside the square: nothing
  EXPECT_FALSE(session_.figures().contains("distance"));
  act(session_, {{"do", "measure"}, {"x", 0.7}, {"y", 0.5}});
  EXPECT_NEAR(session_.figures().at("distance"), 1.6, 1e-6);
  act(session_, {{"do", "measure"}, {"x", 0.7}, {"y", 0.5}});
  EXPECT_FALSE(session_.figures().contains("distance"));
  act(session_, {{"do", "unmeasure"}});
  EXPECT_TRUE(session_.state().measured.empty());
}

// A budget that suffices for everything differs from the full mesh nowhere; the base mesh does, by more than a tenth of
// a pixel, and less is left the more triangles there are.
TEST_F(Study, TheFullMeshAndTheDifferenceStandBeside) {
  open_planet();
  const auto set = [&](const char* setting, const json& value) {
    act(session_, {{"do", "set"}, {"setting", setting}, {"value", value}});
  };
  act(session_, {{"do", "picture_size"}, {"width", 160}, {"height", 120}});
  set("compare", true);
  EXPECT_TRUE(session_.figures().contains("visible_triangles_without"));
  set("beside", "full");
  EXPECT_EQ(session_.figures().at("full_triangles"), 8.0 * 1024.0);
  EXPECT_EQ(session_.frame()->sides[1].refinement.objects[0].triangles.size(), 8U * 1024U);
  set("beside", "difference");
  std::vector<double> rms;
  for (const int budget : {1000, 3000, 20'000}) {
    set("budget", budget);
    rms.push_back(session_.figures().at("depth_rms_px"));
    const Image& image = session_.frame()->sides[1].difference->image;
    EXPECT_EQ(image.width, 160);
    EXPECT_EQ(image.height, 120);
    EXPECT_EQ(image.pixels[0], no_surface_color);
    EXPECT_NE(image.pixels[60 * 160 + 80], no_surface_color);
  }
  EXPECT_GT(rms[0], rms[1]);
  EXPECT_GT(rms[1], 0.0);
  set("tolerance", 0.0);
  set("occlusion", "none");
  act(session_, {{"do", "orbit"}, {"right", 30}, {"up", 10}});  // from another eye it is drawn anew
  EXPECT_LT(session_.figures().at("depth_rms_px"), rms[1]);
  // Hidden objects are in neither.
  act(session_, {{"do", "open"}, {"file", folder_.write("other.json", planet_scene(3)).string()}});
  EXPECT_EQ(session_.figures().at("full_triangles"), 8.0 * 1024.0 + 8.0 * 64.0);
  act(session_, {{"do", "show"}, {"object", session_.state().objects->at(0).id}, {"shown", false}});
  EXPECT_EQ(session_.figures().at("full_triangles"), 8.0 * 64.0);
  EXPECT_EQ(session_.state().errors, 0);
}

TEST_F(Study, WhatIsClippedCannotBePicked) {
  open_square();
  const auto is_hit = [&](double x) {
    act(session_, {{"do", "pick"}, {"x", x}, {"y", 0.5}});
    return session_.figures().at("picked") == 1.0;
  };
  const auto set = [&](const char* setting, const json& value) {
    act(session_, {{"do", "set"}, {"setting", setting}, {"value", value}});
  };
  EXPECT_TRUE(is_hit(0.3) && is_hit(0.7));
  set("clip_axis", "x");
  EXPECT_TRUE(is_hit(0.3) && !is_hit(0.7));
  set("clip_flip", true);
  EXPECT_TRUE(!is_hit(0.3) && is_hit(0.7));
  set("clip_at", 0.0);  // all of it is beyond the plane
  EXPECT_TRUE(is_hit(0.3) && is_hit(0.7));
}

}  // namespace
}  // namespace occlod::viewer::test
