#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "io/mesh_files.h"
#include "support/wedges.h"

namespace occlod {
namespace {

constexpr const char* three_vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

class ReadObj : public testing::Test {
 protected:
  [[nodiscard]] CleanMesh read(const std::string& text) const { return folder_.read("a.obj", text); }
  [[nodiscard]] std::string complaint(const std::string& text) const { return folder_.complaint("a.obj", text); }

  test::TestFolder folder_;
};

TEST_F(ReadObj, TakesEveryFormOfFaceCorner) {
  for (const char* face :
       {"f 1 2 3", "f 1/1 2/2 3/1", "f 1//1 2//1 3//1", "f 1/1/1 2/2/1 3/1/1", "f -3 -2 -1", "f -3//-1 -2//-1 -1//-1",
        "f -3/-2/-1 -2/-1/-1 -1/-2/-1", "f 1 \\\n 2 3", "f 1 2\\\r\n3", "  f\t1 2 3  # it"}) {
    const CleanMesh result = read(std::string(three_vertices) + "vt 0.5 0.25\nvt 1\nvn 0 0 2\n" + face + "\n");
    ASSERT_EQ(result.mesh.triangles.size(), 1u) << face;
    EXPECT_EQ(result.mesh.triangles[0], Triangle(0, 1, 2)) << face;
    const bool has_normals = std::string_view(face).find("//") != std::string_view::npos ||
                             std::string_view(face).ends_with("/1/1") || std::string_view(face).ends_with("/-2/-1");
    const bool has_texture = std::strchr(face, '/') != nullptr && std::strstr(face, "//") == nullptr;
    const std::vector<glm::vec2> coordinates = {{0.5F, 0.25F}, {1, 0}, {0.5F, 0.25F}};
    EXPECT_EQ(result.mesh.texture_coordinates, has_texture ? coordinates : std::vector<glm::vec2>()) << face;
    EXPECT_EQ(result.mesh.normals.size(), has_normals ? 3u : 0u) << face;
    for (const glm::vec3& normal : result.mesh.normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1)) << face;
  }
}

TEST_F(ReadObj, LineEndsAndTheLastLineMayVary) {
  for (const char* text : {"v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3",
                           "\n\n# c \\\nv 0 0 0\nv 1 0 0\n\nv 0 1 0\nf 1 2 3"}) {
    EXPECT_EQ(read(text).mesh.vertex_count(), 3u) << text;
  }
}

TEST_F(ReadObj, NegativeIndicesCountFromTheNewestVertexSoFar) {
  const CleanMesh result = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -4 -1 -2\n");
  // Before the second face there are four vertices: -4 is the first, -1 the fourth, -2 the third.
  EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 3, 2}}));
}

TEST_F(ReadObj, FacesMayComeBeforeTheirVertices) {
  EXPECT_EQ(read(std::string("f 1 2 3\n") + three_vertices).mesh.triangles[0], Triangle(0, 1, 2));
}

TEST_F(ReadObj, ReadsColoursOfEitherScaleAndIgnoresW) {
  const auto second = [&](const std::string& extra) {
    return read("v 0 0 0 0 0 0\nv 1 0 0 " + extra + "\nv 0 1 0 0 0 0\nf 1 2 3\n").mesh.colors.at(1);
  };
  EXPECT_EQ(second("1 0.5 0"), glm::u8vec4(255, 128, 0, 255));  // 0.5 * 255 + 0.5 = 128
  EXPECT_EQ(second("255 17 0"), glm::u8vec4(255, 17, 0, 255));
  EXPECT_TRUE(read("v 0 0 0 1\nv 1 0 0 0.5\nv 0 1 0 1\nf 1 2 3\n").mesh.colors.empty());
  const CleanMesh mixed = read("v 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(mixed.mesh.colors,
            (std::vector<glm::u8vec4>{{255, 255, 255, 255}, {255, 0, 0, 255}, {255, 255, 255, 255}}));
}

// Vertices 1 and 3 have both normals, 2 and 4 one.
TEST_F(ReadObj, KeepsTheNormalOfEachCorner) {
  const CleanMesh result =
      read("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n");
  EXPECT_EQ(test::wedge_problem(result.mesh), "");
  EXPECT_EQ(result.mesh.extra_wedges, (std::vector<VertexId>{0, 2}));
  for (const WedgeId corner : {result.mesh.corners[0].x, result.mesh.corners[0].y, result.mesh.corners[0].z})
    EXPECT_EQ(result.mesh.normals[corner], glm::vec3(0, 0, 1));
  for (const WedgeId corner : {result.mesh.corners[1].x, result.mesh.corners[1].y, result.mesh.corners[1].z})
    EXPECT_EQ(result.mesh.normals[corner], glm::vec3(1, 0, 0));
  EXPECT_EQ(result.report.seam_vertices, 2u);
  EXPECT_EQ(result.report.vertices_read, 4u);
  EXPECT_EQ(result.report.vertices_welded, 0u);
}

// A square of two triangles with a texture seam along the diagonal, by way of equal vt lines under several numbers.
TEST_F(ReadObj, KeepsTheTextureCoordinateOfEachCorner) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const std::string vt = "vt 0 0\nvt 0.1 0\nvt 0.1 0.1\nvt 0 0.1\nvt 0 0\nvt 0.7 0.3\n";
  const CleanMesh seam = read(v + vt + "f 1/1 2/2 3/3\nf 1/5 3/6 4/4\n");  // 5 is 1 again
  EXPECT_EQ(test::wedge_problem(seam.mesh), "");
  EXPECT_EQ(seam.mesh.extra_wedges, std::vector<VertexId>{2});
  EXPECT_EQ(seam.mesh.texture_coordinates,
            (std::vector<glm::vec2>{{0, 0}, {0.1F, 0}, {0.1F, 0.1F}, {0, 0.1F}, {0.7F, 0.3F}}));
  EXPECT_EQ(seam.mesh.corners, (std::vector<Triangle>{{0, 1, 2}, {0, 4, 3}}));
  EXPECT_EQ(seam.report.left_out, LeftOut{});
  // Polygons keep theirs when they are cut. Corners without one have (0, 0).
  const CleanMesh polygon = read(v + vt + "f 1/6 2/2 3/3 4\n");
  EXPECT_EQ(polygon.mesh.texture_coordinates, (std::vector<glm::vec2>{{0.7F, 0.3F}, {0.1F, 0}, {0.1F, 0.1F}, {0, 0}}));
  EXPECT_EQ(polygon.report.left_out.count("unused texture coordinates (vt)"), 3u);  // 1, 4 and 5
  // A coordinate that is not finite becomes (0, 0) and counts as left out.
  const CleanMesh nan = read(v + "vt nan 1\nvt 1 1\nf 1/1 2/2 3/2\n");
  EXPECT_EQ(nan.mesh.texture_coordinates, (std::vector<glm::vec2>{{0, 0}, {1, 1}, {1, 1}}));
  EXPECT_EQ(nan.report.left_out.count("texture coordinates that are not finite"), 1u);
}

// Attributes may come after the faces that use them, and before the vertices.
TEST_F(ReadObj, AttributesMayComeInAnyOrder) {
  const CleanMesh result =
      read(std::string("vn 1 0 0\nf 1/1/1 2/2/1 3/1/2\nvt 1 2\nvt 3 4\nvn 0 1 0\n") + three_vertices);
  EXPECT_EQ(result.mesh.texture_coordinates, (std::vector<glm::vec2>{{1, 2}, {3, 4}, {1, 2}}));
  EXPECT_EQ(result.mesh.normals, (std::vector<glm::vec3>{{1, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

// As many coordinates at one vertex as there are faces: linear in the faces.
TEST_F(ReadObj, ReadsAVertexWithManyCoordinates) {
  std::string text = "v 0 0 0\n";
  const int n = 30'000;
  for (int i = 0; i <= n; ++i) text += "v " + std::to_string(i + 1) + " 1 0\nvt " + std::to_string(i) + " 0\n";
  for (int i = 0; i < n; ++i) {
    const std::string a = std::to_string(i + 2), b = std::to_string(i + 3), t = std::to_string(i + 1);
    text += "f 1/" + t + " " + a + "/1 " + b + "/1\n";
  }
  const CleanMesh result = read(text);
  EXPECT_EQ(result.mesh.extra_wedges, std::vector<VertexId>(static_cast<std::size_t>(n - 1), 0));
}

// What is missing after a slash is absent.
TEST_F(ReadObj, SlashesMayHaveNothingBehindThem) {
  for (const char* face : {"f 1/ 2/ 3/", "f 1// 2// 3//", "fo 1 2// 3/"}) {
    const CleanMesh result = read(std::string(three_vertices) + face + "\n");
    EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}})) << face;
    EXPECT_TRUE(result.mesh.normals.empty() && result.mesh.texture_coordinates.empty()) << face;
    EXPECT_EQ(result.report.left_out, LeftOut{}) << face;
  }
  const CleanMesh textured = read(std::string(three_vertices) + "vt 1 2\nf 1/1/ 2/1/ 3/-1/\n");
  EXPECT_EQ(textured.mesh.texture_coordinates, std::vector<glm::vec2>(3, {1, 2}));
}

// Indices of normals in a file that has none, and of texture coordinates, cost these and not the mesh.
TEST_F(ReadObj, IndicesOfAttributesThatTheFileLacksAreCounted) {
  const CleanMesh normals = read(std::string(three_vertices) + "vt 1 2\nf 1/1/1 2/1/2 3/1/3\nf 1/1/-1 3/1/-2 2/1\n");
  EXPECT_EQ(normals.mesh.triangle_count(), 2u);
  EXPECT_EQ(normals.mesh.texture_coordinates, std::vector<glm::vec2>(3, {1, 2}));
  EXPECT_TRUE(normals.mesh.normals.empty());
  EXPECT_EQ(normals.report.left_out.count("normal indices without vn"), 5u);
  const CleanMesh texture = read(std::string(three_vertices) + "vn 0 0 1\nf 1/1/1 2/2/1 3/7/1\n");
  EXPECT_EQ(texture.mesh.normals, std::vector<glm::vec3>(3, {0, 0, 1}));
  EXPECT_TRUE(texture.mesh.texture_coordinates.empty());
  EXPECT_EQ(texture.report.left_out.count("texture indices without vt"), 3u);
}

// One scale for the whole file, and alpha as some programs add it.
TEST_F(ReadObj, ScalesColoursByTheWholeFile) {
  const auto colors = [&](const std::string& a, const std::string& b) {
    return read("v 0 0 0 " + a + "\nv 1 0 0 " + b + "\nv 0 1 0 " + b + "\nf 1 2 3\n").mesh.colors;
  };
  EXPECT_EQ(colors("1.0001 0 0", "0.5 1 1").at(1), glm::u8vec4(128, 255, 255, 255));
  EXPECT_EQ(colors("200 0 0", "1 1 1").at(1), glm::u8vec4(1, 1, 1, 255));
  EXPECT_EQ(colors("1 0 0 0.5", "0 1 1").at(0), glm::u8vec4(255, 0, 0, 128));
}

TEST_F(ReadObj, IgnoresWhatHasNoPartInTheSurface) {
  const CleanMesh result =
      read(std::string("o x\ng y\ns off\nvt 0 0\nvp 1\nl 1 2\np 1\n") + three_vertices + "f 1 2 3\n");
  EXPECT_EQ(result.report.vertices_read, 3u);
  EXPECT_EQ(result.report.polygons_read, 1u);
}

TEST_F(ReadObj, ReadsNumbersInEveryNotation) {
  const CleanMesh result = read("v +1 -.5 1e2\nv 1. 2E-1 -0\nv 0.1 1e-50 3\nf 1 2 3\n");
  EXPECT_EQ(result.mesh.positions[0], glm::vec3(1, -0.5f, 100));
  EXPECT_EQ(result.mesh.positions[1], glm::vec3(1, 0.2f, 0));
  EXPECT_EQ(result.mesh.positions[2], glm::vec3(0.1f, 0, 3));  // 1e-50 is below the smallest float
}

TEST_F(ReadObj, NamesTheLineOfEveryFault) {
  const std::string v = three_vertices;
  EXPECT_CONTAINS(complaint("v 0 0 0\nv 1 0\n"), "line 2: z of a vertex is missing");
  EXPECT_CONTAINS(complaint("v 0 0 0\nv 1 zero 0\n"), "line 2: y of a vertex is 'zero', which is not a number");
  EXPECT_CONTAINS(complaint("v 0 0 1,5\n"), "line 1: z of a vertex is '1,5'");
  EXPECT_CONTAINS(complaint("v 0 0 1.#INF\n"), "'1.#INF'");  // no comment begins inside a word
  EXPECT_CONTAINS(complaint("v 0 0 +-1\n"), "not a number");
  EXPECT_CONTAINS(complaint("v 0 0 1 x\n"), "line 1: the fourth number");
  EXPECT_CONTAINS(complaint("vn 0 0\n"), "line 1: z of a normal is missing");
  EXPECT_CONTAINS(complaint(v + "f 1 2 4\nf 1 2 3\n"), "line 4: a face uses vertex 4, but there are only 3");
  EXPECT_CONTAINS(complaint(v + "f 1 2 3\nf 0 1 2\n"), "line 5: the face corner '0' is out of range");
  EXPECT_CONTAINS(complaint(v + "f 1 2 -4\n"), "line 4: the face corner '-4' is out of range");
  EXPECT_CONTAINS(complaint(v + "f 1 2 4294967296\n"), "line 4");
  EXPECT_CONTAINS(complaint(v + "f 1 2 99999999999999999999\n"), "line 4");
  EXPECT_CONTAINS(complaint(v + "\nf 1 \\\n 2\n"), "line 5: a face needs three corners or more, but has 2");
  EXPECT_CONTAINS(complaint(v + "vn 0 0 1\nf 1//1 2//2 3//1\n"), "line 5: a face uses normal 2, but there are 1");
  EXPECT_CONTAINS(complaint("vt\n"), "line 1: u of a texture coordinate is missing");
  EXPECT_CONTAINS(complaint("vt 0 x\n"), "line 1: v of a texture coordinate is 'x'");
  EXPECT_CONTAINS(complaint(v + "vt 0 1\nf 1/1 2/1 3/1\nf 1/2 2/1 3/1\nf 1/1 3/1 2/2\n"),
                  "line 6: a face uses texture coordinate 2, but there are 1");
  EXPECT_CONTAINS(complaint(v + "vn 0 0 1\nf 1//2 2//2 3//2\n"), "line 5: a face uses normal 2, but there are 1");
  EXPECT_CONTAINS(complaint(v + "vt 0 1\nf 1/1 2/-2 3/1\n"), "line 5: the face corner '2/-2' is out of range");
  EXPECT_CONTAINS(complaint(v + "f 1/0 2/1 3/1\n"), "line 4: the face corner '1/0' is out of range");
  for (const char* corner : {"1///1", "1///", "1/2/3/4", "1/2/3/", "/", "x", "1.5", "1/x", "//1", "1//0"}) {
    EXPECT_CONTAINS(complaint(v + "f 2 3 " + corner + "\n"), "line 4: the face corner") << corner;
  }
  EXPECT_CONTAINS(complaint("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), "line 2: a coordinate of a vertex is NaN");
  EXPECT_CONTAINS(complaint("v 0 0 0\nv 0 0 0\nv 0 1e39 0\nf 1 2 3\n"), "line 3: a coordinate");
  EXPECT_CONTAINS(complaint(v), "has no faces");
  EXPECT_CONTAINS(complaint("v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n"), "no triangle with three different corners");
}

TEST_F(ReadObj, AcceptsANonFiniteVertexThatNothingUses) {
  const CleanMesh result = read(std::string(three_vertices) + "v inf 0 0\nf 1 2 3\n");
  EXPECT_EQ(result.report.nonfinite_vertices, 1u);
  EXPECT_EQ(result.mesh.vertex_count(), 3u);
}

}  // namespace
}  // namespace occlod
