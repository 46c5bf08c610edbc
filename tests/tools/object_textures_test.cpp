// Images of meshes: found, missing, embedded, or a checker instead.
#include "object_textures.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "image_file.h"
#include "occlod/base.h"
#include "occlod/picture.h"
#include "support/meshes.h"

namespace occlod::tool {
namespace {

namespace fs = std::filesystem;

Texture in_file(const std::string& name) {
  Texture texture;
  texture.file = name;
  return texture;
}

Texture embedded(const std::vector<std::uint8_t>& bytes) {
  Texture texture;
  texture.mime_type = "image/png";
  texture.bytes = bytes;
  return texture;
}

class ObjectTexturesTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("textures_" + std::to_string(::getpid()));
    fs::create_directories(folder_ / "images");
    write_png(folder_ / "images/red.png", {1, 1, {{255, 0, 0, 255}}});
  }
  void TearDown() override { fs::remove_all(folder_); }

  // A square of two triangles, the second of another material, and vertices of its own there.
  static TriangleMesh mesh(const Texture& texture) {
    TriangleMesh mesh = test::grid(1, 1);
    mesh.corners = mesh.triangles;
    for (const VertexId v : {0U, 3U}) {
      mesh.extra_wedges.push_back(v);
      mesh.positions.push_back(mesh.positions[v]);
    }
    mesh.corners[1] = {mesh.triangles[1].x == 0 ? 4U : mesh.triangles[1].x, mesh.triangles[1].y, mesh.triangles[1].z};
    mesh.texture_coordinates.assign(mesh.positions.size(), {0.5F, 0.5F});
    mesh.triangle_materials = {0, 1};
    mesh.materials.resize(2);
    mesh.materials[0].base_color = {0.5F, 1.0F, 1.0F, 1.0F};
    mesh.materials[1].texture = 0;
    mesh.textures = {texture};
    return mesh;
  }

  ObjectTextures textures(const TriangleMesh& mesh, TextureChoice choice) {
    return {mesh, folder_, choice, [&](const std::string& line) { notes_.push_back(line); }};
  }

  static glm::vec3 color(const ObjectTextures& textures, std::size_t material) {
    return textures.texture().materials[material].image->sample({0.5, 0.5}, {0, 0}, {0, 0});
  }

  fs::path folder_;
  std::vector<std::string> notes_;
};

TEST_F(ObjectTexturesTest, AreFoundBesideTheMesh) {
  for (const char* name : {"images/red.png", "images\\red.png"}) {
    const TriangleMesh square = mesh(in_file(name));
    const ObjectTextures found = textures(square, TextureChoice::automatic);
    ASSERT_EQ(found.texture().materials.size(), 2U);
    EXPECT_EQ(found.texture().materials[0].image, nullptr);
    EXPECT_EQ(found.texture().materials[0].base_color.x, 0.5F);
    EXPECT_EQ(color(found, 1), glm::vec3(1, 0, 0));
    EXPECT_TRUE(notes_.empty());
    EXPECT_TRUE(found.has_image());
  }
}

// Triangle 1 alone has wedge 4, and material 1.
TEST_F(ObjectTexturesTest, GiveEachWedgeTheMaterialOfItsTriangle) {
  const TriangleMesh square = mesh(in_file("images/red.png"));
  const ObjectTextures found = textures(square, TextureChoice::automatic);
  ASSERT_EQ(found.texture().vertex_materials.size(), square.wedge_count());
  EXPECT_EQ(found.texture().vertex_materials[4], 1U);
  EXPECT_EQ(found.texture().vertex_materials[square.triangles[0].x], 0U);
}

TEST_F(ObjectTexturesTest, AreReadFromTheMeshItself) {
  std::ifstream file(folder_ / "images/red.png", std::ios::binary);
  const std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(file)), {});
  const TriangleMesh square = mesh(embedded(bytes));
  EXPECT_EQ(color(textures(square, TextureChoice::file), 1), glm::vec3(1, 0, 0));
}

TEST_F(ObjectTexturesTest, MissingOnesAreOneLine) {
  const TriangleMesh square = mesh(in_file("images/green.png"));
  const ObjectTextures found = textures(square, TextureChoice::automatic);
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_NE(notes_[0].find("green.png"), std::string::npos);
  EXPECT_EQ(found.texture().materials[1].image, nullptr);
  EXPECT_FALSE(found.has_image());
  EXPECT_THROW(textures(square, TextureChoice::file), Error);
}

TEST_F(ObjectTexturesTest, BadImagesAreOneLine) {
  std::ofstream(folder_ / "images/red.png") << "no image";
  const TriangleMesh square = mesh(in_file("images/red.png"));
  EXPECT_FALSE(textures(square, TextureChoice::automatic).has_image());
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_NE(notes_[0].find("red.png"), std::string::npos);
  EXPECT_THROW((void)decode_image({}, "nothing"), Error);
}

TEST_F(ObjectTexturesTest, CheckersNeedCoordinatesAlone) {
  TriangleMesh square = mesh({});
  EXPECT_TRUE(textures(square, TextureChoice::checker).has_image());
  square.materials.clear();
  square.triangle_materials.clear();
  EXPECT_TRUE(textures(square, TextureChoice::checker).has_image());
  square.texture_coordinates.clear();
  EXPECT_FALSE(textures(square, TextureChoice::checker).has_image());
  EXPECT_TRUE(notes_.empty());
}

TEST_F(ObjectTexturesTest, NoneIsNothing) {
  const TriangleMesh square = mesh(in_file("images/green.png"));
  EXPECT_TRUE(textures(square, TextureChoice::none).texture().materials.empty());
  EXPECT_TRUE(notes_.empty());
}

}  // namespace
}  // namespace occlod::tool
