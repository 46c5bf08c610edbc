// Coordinates with more digits than floats have: what readers make of them, and files that keep them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "hlod/store/ohlod.h"
#include "io/mesh_files.h"
#include "occlod/build_hierarchy.h"
#include "occlod/build_hlod.h"
#include "occlod/mesh.h"
#include "occlod/mesh_file.h"
#include "occlod/node_store.h"

namespace occlod {
namespace {

constexpr int side = 12;              // squares along each side of the patch
constexpr double far_x = 691607.37;   // UTM metres, where floats are 0.06 apart
constexpr double far_y = 5334760.81;  // where they are 0.5 apart
constexpr double tenth_mm = 1e-4;

// A patch of 1.2 m, whose floats would lie on a few lines.
std::vector<glm::dvec3> patch(const glm::dvec3& at = {far_x, far_y, 519.93}) {
  std::vector<glm::dvec3> points;
  for (int y = 0; y <= side; ++y)
    for (int x = 0; x <= side; ++x) points.push_back(at + glm::dvec3(0.1 * x, 0.1 * y, 0.01 * ((x * 7 + y * 3) % 5)));
  return points;
}

std::vector<Triangle> triangles(VertexId first = 0) {
  std::vector<Triangle> result;
  for (VertexId y = 0; y < side; ++y)
    for (VertexId x = 0; x < side; ++x) {
      const VertexId v = first + y * (side + 1) + x;
      result.emplace_back(v, v + 1, v + side + 2);
      result.emplace_back(v, v + side + 2, v + side + 1);
    }
  return result;
}

std::string ply(const std::vector<glm::dvec3>& points, bool is_text, const std::string& type = "double",
                VertexId first = 0) {
  test::Bytes file(
      fmt::format("ply\nformat {} 1.0\nelement vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\nelement face "
                  "{}\nproperty list uchar int vertex_indices\nend_header\n",
                  is_text ? "ascii" : "binary_little_endian", points.size(), type, type, type, triangles().size()));
  std::string text;
  for (const glm::dvec3& p : points) {
    text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
    file.add(p.x).add(p.y).add(p.z);
  }
  std::string header = file.str().substr(0, file.str().find("end_header\n") + 11);
  for (const Triangle& t : triangles(first)) {
    text += fmt::format("3 {} {} {}\n", t.x, t.y, t.z);
    file.add(std::uint8_t{3}).add(t.x).add(t.y).add(t.z);
  }
  return is_text ? header + text : file.str();
}

std::string obj(const std::vector<glm::dvec3>& points) {
  std::string text;
  for (const glm::dvec3& p : points) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  for (const Triangle& t : triangles()) text += fmt::format("f {} {} {}\n", t.x + 1, t.y + 1, t.z + 1);
  return text;
}

std::string off(const std::vector<glm::dvec3>& points) {
  std::string text = fmt::format("OFF\n{} {} 0\n", points.size(), triangles().size());
  for (const glm::dvec3& p : points) text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  for (const Triangle& t : triangles()) text += fmt::format("3 {} {} {}\n", t.x, t.y, t.z);
  return text;
}

std::vector<glm::dvec3> coordinates_of(const TriangleMesh& mesh) {
  std::vector<glm::dvec3> all;
  for (const glm::vec3& p : mesh.positions) all.push_back(mesh.origin + glm::dvec3(p));
  return all;
}

double farthest_apart(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(a[i][k] - b[i][k]));
  return most;
}

// The mesh keeps the points, in their order, and no triangle has lost its area.
void expect_kept(const CleanMesh& read, const std::vector<glm::dvec3>& points) {
  EXPECT_NE(read.mesh.origin, glm::dvec3(0.0));
  EXPECT_LT(farthest_apart(coordinates_of(read.mesh), points), tenth_mm);
  EXPECT_EQ(read.mesh.triangle_count(), triangles().size());
  EXPECT_EQ(read.report.zero_area_triangles, 0U);
  EXPECT_EQ(read.report.repeated_index_triangles, 0U);
}

TEST(Origin, EveryFormatWithDigitsKeepsThem) {
  const test::TestFolder folder;
  expect_kept(folder.read("binary.ply", ply(patch(), false)), patch());
  expect_kept(folder.read("text.ply", ply(patch(), true)), patch());
  expect_kept(folder.read("floats_with_digits.ply", ply(patch(), true, "float")), patch());
  expect_kept(folder.read("a.obj", obj(patch())), patch());
  expect_kept(folder.read("a.off", off(patch())), patch());
  const glm::dvec3 earth_centred(3980574.247, -102.127, 4966824.522);
  expect_kept(folder.read("earth.ply", ply(patch(earth_centred), false)), patch(earth_centred));
}

TEST(Origin, FloatsThatAreFarAwayStayAsTheyAre) {
  std::vector<glm::dvec3> floats;
  for (const glm::dvec3& p : patch()) floats.emplace_back(glm::vec3(p));
  const test::TestFolder folder;
  const std::string doubles = ply(floats, false);
  const CleanMesh read = folder.read("a.ply", doubles);
  EXPECT_EQ(read.mesh.origin, glm::dvec3(0.0));
  // Their shortest digits would have an origin: 691607.4 is the float 691607.375.
  for (const char* name : {"b.ply", "b.obj", "b.off", "b.glb"}) {
    write_mesh(folder.path() / name, read.mesh);
    const TriangleMesh back = read_mesh(folder.path() / name).mesh;
    EXPECT_EQ(back.origin, glm::dvec3(0.0)) << name;
    EXPECT_EQ(back.positions, read.mesh.positions) << name;
  }
}

TEST(Origin, NearMeshesHaveNoneAndTheirPositionsAreTheFloats) {
  const test::TestFolder folder;
  for (const double at : {0.0, 0.3, 10.1}) {
    const std::vector<glm::dvec3> points = patch(glm::dvec3(at));
    const CleanMesh read = folder.read("a.obj", obj(points));
    EXPECT_EQ(read.mesh.origin, glm::dvec3(0.0)) << at;
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(read.mesh.positions[i], glm::vec3(points[i])) << at;
  }
}

TEST(Origin, VerticesThatNoTriangleUsesDoNotCount) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  std::vector<glm::dvec3> points = patch();
  const std::vector<glm::dvec3> unused = {{0.0, 0.0, 0.0}, {nan, 1.0, 0.1}, {1.0, infinity, 1e300}};
  const test::TestFolder folder;
  std::vector<glm::dvec3> before = unused, behind = points;
  before.insert(before.end(), points.begin(), points.end());
  behind.insert(behind.end(), unused.begin(), unused.end());
  expect_kept(folder.read("before.ply", ply(before, false, "double", 3)), points);
  expect_kept(folder.read("behind.ply", ply(behind, false)), points);
}

TEST(Origin, CoordinatesBeyondTheRangeAreRefusedAsBefore) {
  const test::TestFolder folder;
  std::vector<glm::dvec3> larger;
  for (const glm::dvec3& p : patch(glm::dvec3(0.0))) larger.push_back(glm::dvec3(2e37) + 1e35 * p);
  EXPECT_CONTAINS(folder.complaint("a.ply", ply(larger, false)), "is farther than 1.5e37 from the origin");
}

TEST(Origin, MinusZeroIsZero) {
  std::vector<glm::dvec3> points = patch();
  for (glm::dvec3& p : points) p.z = -0.0;
  const test::TestFolder folder;
  const CleanMesh read = folder.read("a.ply", ply(points, false));
  expect_kept(read, points);
  for (const glm::vec3& p : read.mesh.positions) EXPECT_FALSE(std::signbit(p.z));
}

TEST(Origin, FilesOfNeighboursMeetWhereTheirCoordinatesDo) {
  const test::TestFolder folder;
  const std::vector<glm::dvec3> left = patch(), right = patch({left[side].x, far_y, 519.93});
  const auto a = coordinates_of(folder.read("a.ply", ply(left, false)).mesh);
  const auto b = coordinates_of(folder.read("b.ply", ply(right, false)).mesh);
  for (std::size_t y = 0; y <= side; ++y) {
    EXPECT_EQ(a[y * (side + 1) + side].x, b[y * (side + 1)].x);
    EXPECT_EQ(a[y * (side + 1) + side].y, b[y * (side + 1)].y);
  }
}

TEST(Origin, WrittenAndReadAgainToTheBit) {
  const test::TestFolder folder;
  const TriangleMesh mesh = folder.read("a.ply", ply(patch(), false)).mesh;
  for (const char* name : {"b.ply", "b.obj", "b.off", "b.glb"}) {
    write_mesh(folder.path() / name, mesh);
    const TriangleMesh back = read_mesh(folder.path() / name).mesh;
    EXPECT_EQ(back.origin, mesh.origin) << name;
    EXPECT_EQ(back.positions, mesh.positions) << name;
    EXPECT_EQ(back.triangles, mesh.triangles) << name;
  }
}

TEST(Origin, StlStaysRelativeAndItsHeaderSaysTo) {
  const test::TestFolder folder;
  const TriangleMesh mesh = folder.read("a.ply", ply(patch(), false)).mesh;
  write_mesh(folder.path() / "b.stl", mesh);
  EXPECT_CONTAINS(test::bytes_of(folder.path() / "b.stl").substr(0, 80),
                  fmt::format("relative to {} {} {}", mesh.origin.x, mesh.origin.y, mesh.origin.z));
  TriangleMesh back = read_mesh(folder.path() / "b.stl").mesh;
  back.origin = mesh.origin;
  EXPECT_EQ(back.triangle_count(), mesh.triangle_count());
  for (const glm::dvec3& p : coordinates_of(back)) EXPECT_LT(std::abs(p.y - far_y), 1.3);
}

TEST(Origin, HierarchiesAndTheirFilesKeepIt) {
  const test::TestFolder folder;
  const TriangleMesh mesh = folder.read("a.ply", ply(patch(), false)).mesh;
  const Hierarchy hierarchy = build_hierarchy(mesh);
  for (const OlodCompression compression : {OlodCompression::none, OlodCompression::zstd}) {
    write_olod(folder.path() / "a.olod", hierarchy, {}, compression);
    const OlodFile file = read_olod(folder.path() / "a.olod");
    EXPECT_EQ(file.version, olod_version);
    EXPECT_EQ(file.hierarchy.data().origin, mesh.origin);
    EXPECT_TRUE(restores(file.hierarchy, mesh));
    EXPECT_TRUE(validate(file.hierarchy, 4).empty());
    const TriangleMesh cut = cut_mesh(file.hierarchy, cut_to_triangles(file.hierarchy, 100));
    EXPECT_EQ(cut.origin, mesh.origin);
  }
  // The same surface relative to something else; floats are coarser there, so it takes two moves to be exact.
  TriangleMesh moved = mesh;
  move_origin(moved, mesh.origin + glm::dvec3(1.0, -2.0, 0.5));
  TriangleMesh back = moved;
  move_origin(back, mesh.origin);
  EXPECT_TRUE(restores(build_hierarchy(moved), back));
  back.origin.x += 1.0;
  EXPECT_FALSE(restores(build_hierarchy(moved), back));
}

TEST(Origin, FilesWithoutOneAreAsBefore) {
  const test::TestFolder folder;
  const TriangleMesh near = folder.read("a.ply", ply(patch(glm::dvec3(0.0)), false)).mesh;
  write_olod(folder.path() / "a.olod", build_hierarchy(near), {});
  EXPECT_EQ(read_olod(folder.path() / "a.olod").version, 2U);
  EXPECT_EQ(test::bytes_of(folder.path() / "a.olod").find("ORIG"), std::string::npos);
  write_ohlod(folder.path() / "a.ohlod", hlod::build_hlod(near), {});
  EXPECT_EQ(read_ohlod(folder.path() / "a.ohlod").version, 6U);
}

TEST(Origin, HlodsAndTheirFilesKeepIt) {
  const test::TestFolder folder;
  const TriangleMesh mesh = folder.read("a.ply", ply(patch(), false)).mesh;
  hlod::HlodBuildOptions options;
  options.node_triangles = 32;
  const hlod::Hlod built = hlod::build_hlod(mesh, options);
  for (const OlodCompression compression : {OlodCompression::none, OlodCompression::zstd}) {
    write_ohlod(folder.path() / "a.ohlod", built, {}, {.compression = compression});
    const OhlodFile file = read_ohlod(folder.path() / "a.ohlod");
    EXPECT_EQ(file.version, ohlod::origin_version);
    EXPECT_EQ(file.hlod.data().origin, mesh.origin);
    EXPECT_TRUE(restores(file.hlod, mesh));
    EXPECT_TRUE(validate(file.hlod, 4).empty());
  }
}

TEST(Origin, PiecesWithOthersMoveToThatOfTheFirst) {
  const test::TestFolder folder;
  const TriangleMesh mesh = folder.read("a.ply", ply(patch(), false)).mesh;
  TriangleMesh second = mesh;
  for (glm::vec3& p : second.positions) p.x += 3.0F;
  second.origin.x -= 0.5;
  MeshReport report;
  const hlod::Hlod built = hlod::build_hlod(
      [&](hlod::TriangleSink& sink) {
        sink.add(mesh);
        sink.add(second);
      },
      {}, report);
  EXPECT_EQ(built.data().origin, mesh.origin);
  EXPECT_EQ(built.data().box.max.x, bounding_box(mesh.positions).max.x + 2.5F);
}

TEST(Origin, DamagedOneIsRefused) {
  const test::TestFolder folder;
  const Hierarchy hierarchy = build_hierarchy(folder.read("a.ply", ply(patch(), false)).mesh);
  HierarchyView view = hierarchy.data();
  view.origin.y = std::numeric_limits<double>::infinity();
  const std::filesystem::path path = folder.path() / "a.olod";
  write_olod(path, Hierarchy(view, nullptr), {});
  EXPECT_EQ(test::complaint_of(path, [&] { static_cast<void>(read_olod(path)); }),
            "section ORIG: is not finite or too far away");
}

TEST(Origin, CoordinatesInMemoryAreTreatedAsThoseOfFiles) {
  TriangleMesh mesh;
  mesh.triangles = triangles();
  std::vector<glm::dvec3> points = patch();
  points.emplace_back(0.0);  // unused
  set_coordinates(mesh, points);
  const test::TestFolder folder;
  const TriangleMesh read = folder.read("a.ply", ply(patch(), false)).mesh;
  EXPECT_EQ(mesh.origin, read.origin);
  mesh.positions.pop_back();
  EXPECT_EQ(mesh.positions, read.positions);
}

}  // namespace
}  // namespace occlod
