#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "io/mesh_files.h"
#include "support/test_meshes.h"

namespace occlod {
namespace {

template <typename T>
void put(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

std::string base64(const std::string& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[word >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

// Four corners of the unit square and indices 0 1 2 2 1 3 behind them, in one buffer.
struct Square {
  std::string nodes = R"([{"mesh": 0}])";
  int mode = 4;
  std::vector<std::uint16_t> indices = {0, 1, 2, 2, 1, 3};
  std::size_t index_count = 6;
  bool has_int_indices = false;
  std::string extra;

  [[nodiscard]] std::string gltf() const {
    std::string bytes;
    for (const glm::vec3 p : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(1, 1, 0)})
      for (int k = 0; k < 3; ++k) put(bytes, p[k]);
    for (const std::uint16_t i : indices) has_int_indices ? put(bytes, std::int32_t{i}) : put(bytes, i);
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": )" + nodes + extra +
           R"(, "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": )" +
           std::to_string(mode) +
           R"(}]}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
               {"bufferView": 1, "componentType": )" +
           std::to_string(has_int_indices ? 5124 : 5123) + R"(, "count": )" + std::to_string(index_count) +
           R"(, "type": "SCALAR"}],
               "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": )" +
           std::to_string((has_int_indices ? 4 : 2) * indices.size()) + R"(}], "buffers": [{"byteLength": )" +
           std::to_string(bytes.size()) + R"(, "uri": "data:application/octet-stream;base64,)" + base64(bytes) +
           R"("}]})";
  }
};

glm::vec3 area_vector(const TriangleMesh& mesh) {
  glm::vec3 sum(0.0F);
  for (const Triangle& t : mesh.triangles)
    sum += 0.5F * glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
  return sum;
}

TEST(ReadGltf, TrianglesStripsAndFansKeepTheirFront) {
  const test::TestFolder folder;
  Square square;
  const TriangleMesh triangles = folder.read("a.gltf", square.gltf()).mesh;
  EXPECT_EQ(triangles.triangle_count(), 2U);
  EXPECT_EQ(area_vector(triangles), glm::vec3(0, 0, 1));  // the unit square, facing +z
  square.mode = 5;                                        // strip 0 1 2 3: its second triangle runs 2 1 3
  square.indices = {0, 1, 2, 3};
  square.index_count = 4;
  EXPECT_EQ(area_vector(folder.read("b.gltf", square.gltf()).mesh), glm::vec3(0, 0, 1));
  square.mode = 6;  // fan 0 1 3 2
  square.indices = {0, 1, 3, 2};
  EXPECT_EQ(area_vector(folder.read("c.gltf", square.gltf()).mesh), glm::vec3(0, 0, 1));
}

TEST(ReadGltf, NodesPlaceMeshesAndMirroredOnesKeepTheirFront) {
  const test::TestFolder folder;
  Square square;
  square.nodes =
      R"([{"children": [1, 2], "translation": [10, 0, 0]}, {"mesh": 0, "scale": [2, 2, 2]}, {"mesh": 0, "scale": [-1, 1, 1]}])";
  const TriangleMesh mesh = folder.read("a.gltf", square.gltf()).mesh;
  EXPECT_EQ(mesh.triangle_count(), 4U);
  // 2 x 2 facing +z, and the mirrored unit square: glTF turns its winding, so it faces +z as well.
  EXPECT_EQ(area_vector(mesh), glm::vec3(0, 0, 5));
  float left = 100.0F, right = -100.0F;
  for (const glm::vec3& p : mesh.positions) {
    left = std::min(left, p.x);
    right = std::max(right, p.x);
  }
  EXPECT_EQ(left, 9.0F);
  EXPECT_EQ(right, 12.0F);
}

TEST(ReadGltf, SaysWhatIsWrong) {
  const test::TestFolder folder;
  const auto complaint = [&](const Square& square) { return folder.complaint("bad.gltf", square.gltf()); };
  Square out_of_range;
  out_of_range.indices[3] = 4;
  EXPECT_NE(complaint(out_of_range).find("uses vertex 4"), std::string::npos);
  Square beyond_buffer;
  beyond_buffer.index_count = 600;
  EXPECT_NE(complaint(beyond_buffer).find("reaches beyond its buffer"), std::string::npos);
  Square circle;
  circle.nodes = R"([{"mesh": 0, "children": [1]}, {"children": [0]}])";
  EXPECT_NE(complaint(circle).find("tree of nodes"), std::string::npos);
  Square missing_mesh;
  missing_mesh.nodes = R"([{"mesh": 7}])";
  EXPECT_NE(complaint(missing_mesh), "accepted");
  Square compressed;
  compressed.extra =
      R"(, "extensionsUsed": ["EXT_meshopt_compression"], "extensionsRequired": ["EXT_meshopt_compression"])";
  EXPECT_NE(complaint(compressed).find("EXT_meshopt_compression"), std::string::npos);
  EXPECT_NE(folder.complaint("text.gltf", "{ \"asset\": "), "accepted");
  const std::string folder_as_buffer = R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 4, "uri": "."}]})";
  EXPECT_NE(folder.complaint("folder.gltf", folder_as_buffer).find("is no file"), std::string::npos);
  EXPECT_NE(folder.complaint("short.glb", "glTF"), "accepted");
}

TEST(ReadGltf, IntsAreReadAsTheyAre) {
  // Type 5124 is in no standard, but the parser knows its size: four bytes, the last four of the buffer for index 5.
  const test::TestFolder folder;
  Square square;
  square.has_int_indices = true;
  EXPECT_EQ(area_vector(folder.read("a.gltf", square.gltf()).mesh), glm::vec3(0, 0, 1));
}

TEST(ReadGltf, EveryTruncationOfABinaryFileIsRefusedOrWhole) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(path, "scenes/2CylinderEngine.glb");
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const test::TestFolder folder;
  for (std::size_t size = 0; size < bytes.size(); size += bytes.size() / 23)
    EXPECT_NE(folder.complaint("cut.glb", bytes.substr(0, size)), "accepted") << size << " bytes";
}

TEST(ReadGltf, BinaryFileIsTheSameMeshAsItsFlattenedCopy) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(glb, "scenes/2CylinderEngine.glb");
  OCCLOD_FIND_TEST_MESH_OR_SKIP(ply, "scenes/2CylinderEngine.ply");
  const CleanMesh a = read_mesh(glb), b = read_mesh(ply);
  EXPECT_EQ(a.report.triangles_read, b.report.triangles_read);
  EXPECT_EQ(a.report.vertices_read, b.report.vertices_read);
}

}  // namespace
}  // namespace occlod
