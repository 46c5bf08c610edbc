// Materials of OBJ files that scale and move their textures: map_Kd -s and -o.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "io/mesh_files.h"
#include "occlod/mesh_file.h"

namespace occlod {
namespace {

// Two triangles of the unit square, texture coordinates being places, in the order of its corners.
constexpr const char* square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
constexpr const char* halves[] = {"f 1/1 2/2 3/3\n", "f 1/1 3/3 4/4\n"};

using Corners = std::array<glm::vec2, 3>;

class PlaceTextures : public testing::Test {
 protected:
  [[nodiscard]] CleanMesh read(const std::string& library, const std::string& faces) const {
    static_cast<void>(folder_.write("a.mtl", library));
    return folder_.read("a.obj", std::string("mtllib a.mtl\n") + square + faces);
  }
  [[nodiscard]] static std::vector<Corners> corners_of(const TriangleMesh& mesh) {
    std::vector<Corners> result;
    for (const Triangle& t : mesh.wedge_triangles())
      result.push_back(
          {mesh.texture_coordinates.at(t.x), mesh.texture_coordinates.at(t.y), mesh.texture_coordinates.at(t.z)});
    return result;
  }
  // Of the corner at (1, 1) of a mesh whose material has this map_Kd line, but for the name of the file.
  [[nodiscard]] glm::vec2 far_corner(const std::string& options) const {
    const TriangleMesh mesh =
        read("newmtl m\nmap_Kd " + options + " t.png\n", std::string("usemtl m\n") + halves[0]).mesh;
    EXPECT_EQ(mesh.textures.at(0).file, "t.png") << options;
    return corners_of(mesh).at(0)[2];
  }
  [[nodiscard]] std::string complaint(const std::string& options) const {
    return test::complaint_of(folder_.path() / "a.mtl", [&] { static_cast<void>(far_corner(options)); });
  }

  test::TestFolder folder_;
};

// Each by its own material, though both halves name the same lines of vt; another material's stay as they are.
TEST_F(PlaceTextures, ScalesThenMovesByMaterial) {
  const std::string library =
      "newmtl a\nmap_Kd -s 2 4 1 -o 0.5 -0.25 0 t.png\nnewmtl b\nmap_Kd t.png\nnewmtl c\nmap_Kd -o 8 16 t.png\n";
  const Corners as_it_is{{{0, 0}, {1, 0}, {1, 1}}}, scaled{{{0.5F, -0.25F}, {2.5F, -0.25F}, {2.5F, 3.75F}}};
  const CleanMesh ab = read(library, std::string("usemtl b\n") + halves[0] + "usemtl a\n" + halves[0]);
  EXPECT_EQ(corners_of(ab.mesh), (std::vector<Corners>{as_it_is, scaled}));
  EXPECT_EQ(ab.mesh.materials.at(0).texture, ab.mesh.materials.at(1).texture) << "one texture, at two places";
  EXPECT_EQ(ab.mesh.textures.size(), 1U);
  EXPECT_EQ(ab.report.left_out.count("unused texture coordinates (vt)"), 1U) << "the line of vt that no face uses";
  // From one material to the other and back; vt lines and libraries may follow, corners may have none.
  const Corners moved{{{8, 16}, {9, 16}, {9, 17}}}, others{{{8, 16}, {9, 17}, {8, 17}}};
  const std::string mixed = std::string("usemtl c\n") + halves[0] + "usemtl a\n" + halves[0] + "usemtl c\n" +
                            halves[1] + "usemtl b\nf 1 2/2 3/3\nusemtl c\nf 1 2/2 3/3\n";
  const std::vector<Corners> expected = {moved, scaled, others, as_it_is, {{{0, 0}, {9, 16}, {9, 17}}}};
  EXPECT_EQ(corners_of(read(library, mixed).mesh), expected);
  static_cast<void>(folder_.write("a.mtl", library));
  EXPECT_EQ(corners_of(folder_.read("b.obj", mixed + square + "mtllib a.mtl\n").mesh), expected);
}

// Corners are counted through polygons of any size; what comes before the first usemtl has no material.
TEST_F(PlaceTextures, FindsTheCornersOfPolygons) {
  const TriangleMesh mesh = read("newmtl a\nmap_Kd -s 2 2 t.png\n",
                                 "f 1/1 2/2 3/3 4/4\nf 1 2 3\nusemtl a\nf 1/1 2/2 3/3 4/4\nf 4/4 3/3 2/2 1/1\n")
                                .mesh;
  std::vector<float> sums;  // over the corners of each triangle
  for (const Corners& c : corners_of(mesh)) sums.push_back(c[0].x + c[0].y + c[1].x + c[1].y + c[2].x + c[2].y);
  ASSERT_EQ(sums.size(), 7U);
  EXPECT_EQ(sums[0] + sums[1], 6.0F) << "3 and 3 with one diagonal, 2 and 4 with the other";
  EXPECT_EQ(sums[2], 0.0F);
  EXPECT_EQ(sums[3] + sums[4], 2.0F * (sums[0] + sums[1]));
  EXPECT_EQ(sums[5] + sums[6], 2.0F * (sums[0] + sums[1]));
}

TEST_F(PlaceTextures, TakesEveryFormOfTheOptions) {
  EXPECT_EQ(far_corner("-s 2 3 5"), glm::vec2(2, 3));
  EXPECT_EQ(far_corner("-s 2"), glm::vec2(2, 1));
  EXPECT_EQ(far_corner("-o 2"), glm::vec2(3, 1));
  EXPECT_EQ(far_corner("-o 0.5 +0.25 7"), glm::vec2(1.5F, 1.25F));
  EXPECT_EQ(far_corner("-o 0.5 0.5 -clamp on -s -1 4 1 -bm 1"), glm::vec2(-0.5F, 4.5F)) << "in any order";
  EXPECT_EQ(far_corner("-s 0 0"), glm::vec2(0, 0)) << "one texel";
  EXPECT_EQ(far_corner("-s 9 9\nmap_Kd -o 1 1"), glm::vec2(2, 2)) << "the last line counts";
  EXPECT_EQ(far_corner("-t 5 5 5 -mm 0 2"), glm::vec2(1, 1)) << "not a place";
  // A texture that is not there has no place.
  EXPECT_EQ(corners_of(read("newmtl m\nmap_Kd -s 2 2\n", std::string("usemtl m\n") + halves[0]).mesh).at(0)[2],
            glm::vec2(1, 1));
}

TEST_F(PlaceTextures, NamesTheLineOfBadNumbers) {
  EXPECT_CONTAINS(complaint("-s"), "line 2: -s of a texture is 't.png', which is not a finite number");
  EXPECT_CONTAINS(complaint("-o 1,5"), "line 2: -o of a texture is '1,5', which is not a finite number");
  EXPECT_CONTAINS(complaint("-s 2 nan"), "line 2: -s of a texture is 'nan', which is not a finite number");
  EXPECT_CONTAINS(complaint("-o 1e999"), "line 2: -o of a texture is '1e999', which is not a finite number");
  EXPECT_EQ(complaint("-s 2 2"), "accepted");
}

// As any texture coordinate that is not finite.
TEST_F(PlaceTextures, CountsWhatLeavesTheRangeOfFloats) {
  const CleanMesh mesh = read("newmtl m\nmap_Kd -s 1e300 1 t.png\n", std::string("usemtl m\n") + halves[0]);
  EXPECT_EQ(mesh.report.left_out.count("texture coordinates that are not finite"), 2U);
  EXPECT_EQ(mesh.report.left_out.count("unused texture coordinates (vt)"), 1U);
  EXPECT_EQ(corners_of(mesh.mesh).at(0), (Corners{{{0, 0}, {0, 0}, {0, 0}}}));
}

// What is written has the coordinates as they are now, and no options; reading it again gives the same bits.
TEST_F(PlaceTextures, IsWrittenAsItIsRead) {
  const TriangleMesh mesh = read("newmtl a\nmap_Kd -s 0.3 0.7 -o 0.1 0.9 t.png\nnewmtl b\nmap_Kd -s 3 3 t.png\n",
                                 std::string("usemtl a\n") + halves[0] + "usemtl b\n" + halves[1])
                                .mesh;
  write_mesh(folder_.path() / "again.obj", mesh);
  const TriangleMesh again = read_mesh(folder_.path() / "again.obj").mesh;
  EXPECT_EQ(corners_of(again), corners_of(mesh));
  EXPECT_EQ(again.materials, mesh.materials);
  EXPECT_EQ(test::bytes_of(folder_.path() / "again.mtl").find('-'), std::string::npos);
  write_mesh(folder_.path() / "third.obj", again);
  EXPECT_EQ(test::bytes_of(folder_.path() / "third.obj").substr(sizeof("mtllib third.mtl")),
            test::bytes_of(folder_.path() / "again.obj").substr(sizeof("mtllib again.mtl")));
}

}  // namespace
}  // namespace occlod
