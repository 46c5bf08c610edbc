#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <glm/geometric.hpp>
#include <initializer_list>
#include <string>
#include <tuple>
#include <utility>
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
  compressed.extra = R"(, "extensionsUsed": ["EXT_of_tomorrow"], "extensionsRequired": ["EXT_of_tomorrow"])";
  EXPECT_NE(complaint(compressed).find("EXT_of_tomorrow"), std::string::npos);
  EXPECT_NE(folder.complaint("text.gltf", "{ \"asset\": "), "accepted");
  // What is no regular file is not there: neither a folder, nor a device without end, nor what a shell would make of
  // it.
  (void)folder.write("four.bin", "1234");
  for (const char* name : {".", "/dev/zero", "$(echo four.bin)", "missing.bin"}) {
    const std::string buffer = R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 4, "uri": ")";
    const std::string text = folder.complaint("buffer.gltf", buffer + name + "\"}]}");
    EXPECT_NE(text.find("not found"), std::string::npos) << text;
  }
  EXPECT_NE(folder.complaint("short.glb", "glTF"), "accepted");
}

// One triangle without indices: positions in the first 36 bytes of the buffer, then other attributes, an accessor each.
struct Attributes {
  struct Attribute {
    std::string name, type;
    int component_type;
    std::string bytes;
    std::string extra;  // of its accessor
  };
  std::vector<Attribute> others;
  std::string rest = R"(, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}])";
  std::string primitive = {};  // instead of the one with all attributes

  [[nodiscard]] std::string gltf() const {
    std::string bytes;
    for (const glm::vec3 p : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)})
      for (int k = 0; k < 3; ++k) put(bytes, p[k]);
    std::string names = R"("POSITION": 0)", views = R"({"buffer": 0, "byteLength": 36})",
                accessors = R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"})";
    for (std::size_t i = 0; i < others.size(); ++i) {
      const Attribute& other = others[i];
      const std::string number = std::to_string(i + 1);
      names += ", \"" + other.name + "\": " + number;
      views += R"(, {"buffer": 0, "byteOffset": )" + std::to_string(bytes.size()) + R"(, "byteLength": )" +
               std::to_string(other.bytes.size()) + "}";
      accessors += R"(, {"bufferView": )" + number + R"(, "componentType": )" + std::to_string(other.component_type) +
                   R"(, "count": 3, "type": ")" + other.type + "\"" + other.extra + "}";
      bytes += other.bytes;
    }
    return R"({"asset": {"version": "2.0"})" + rest + R"(, "meshes": [{"primitives": [)" +
           (primitive.empty() ? R"({"attributes": {)" + names + "}}" : primitive) + R"(]}], "accessors": [)" +
           accessors + R"(], "bufferViews": [)" + views + R"(], "buffers": [{"byteLength": )" +
           std::to_string(bytes.size()) + R"(, "uri": "data:application/octet-stream;base64,)" + base64(bytes) +
           "\"}]}";
  }
};

template <typename T>
std::string three_times(std::initializer_list<T> element) {
  std::string bytes;
  for (int i = 0; i < 3; ++i)
    for (const T component : element) put(bytes, component);
  return bytes;
}

// Normalized integers are fractions of the largest: of signed ones, with -128 cut off at -1; of unsigned ones 51 / 255
// is 0.2, 13107 / 65535 as well. Linear 0.2 is 1.055 * 0.2^(1 / 2.4) - 0.055 = 0.4845 of sRGB, which is 124 of 255.
TEST(ReadGltf, NormalizedIntegersAreFractions) {
  const test::TestFolder folder;
  const std::string normalized = R"(, "normalized": true)";
  const auto read = [&](const Attributes::Attribute& other) {
    return folder.read("a.gltf", Attributes{.others = {other}}.gltf()).mesh;
  };
  for (const auto& [type, bytes] : {std::pair(5120, three_times<std::int8_t>({0, 0, -128})),
                                    std::pair(5122, three_times<std::int16_t>({0, 0, -32767}))}) {
    const TriangleMesh mesh = read({"NORMAL", "VEC3", type, bytes, normalized});
    ASSERT_EQ(mesh.normals.size(), 3U) << type;
    EXPECT_EQ(mesh.normals[1], glm::vec3(0, 0, -1)) << type;
  }
  const std::string shorts = three_times<std::uint16_t>({65535, 0, 13107});
  for (const auto& [shape, type, bytes] :
       {std::tuple("VEC3", 5121, three_times<std::uint8_t>({255, 0, 51})), std::tuple("VEC3", 5123, shorts),
        std::tuple("VEC3", 5126, three_times<float>({1.0F, 0.0F, 0.2F})),
        std::tuple("VEC3", 5130, three_times<double>({1.0, 0.0, 0.2}))}) {
    const TriangleMesh mesh = read({"COLOR_0", shape, type, bytes, normalized});
    ASSERT_EQ(mesh.colors.size(), 3U) << type;
    EXPECT_EQ(mesh.colors[2], glm::u8vec4(255, 0, 124, 255)) << type;
  }
  const TriangleMesh clear = read({"COLOR_0", "VEC4", 5121, three_times<std::uint8_t>({0, 255, 0, 4}), normalized});
  EXPECT_EQ(clear.colors.at(0), glm::u8vec4(0, 255, 0, 4));
}

// Without a scene all nodes are shown that are nobody's child, with their children: here the second, which is moved by
// 5 and shows the first. Lines and what has no positions have no surface.
TEST(ReadGltf, WithoutASceneAllRootsAreShown) {
  const test::TestFolder folder;
  Attributes rooted;
  rooted.rest = R"(, "nodes": [{"mesh": 0}, {"children": [0], "translation": [5, 0, 0]}])";
  const TriangleMesh mesh = folder.read("a.gltf", rooted.gltf()).mesh;
  EXPECT_EQ(mesh.triangle_count(), 1U);
  EXPECT_EQ(mesh.positions.at(0).x, 5.0F);
  Attributes lines;
  lines.primitive =
      R"({"attributes": {"POSITION": 0}, "mode": 1}, {"attributes": {}}, {"attributes": {"POSITION": 0}})";
  EXPECT_EQ(folder.read("b.gltf", lines.gltf()).mesh.triangle_count(), 1U);
}

TEST(ReadGltf, SaysWhatIsWrongWithAttributes) {
  const test::TestFolder folder;
  const auto complaint = [&](const Attributes& file) { return folder.complaint("bad.gltf", file.gltf()); };
  const auto has = [&](const Attributes& file, const char* words) {
    const std::string text = complaint(file);
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  const std::string two = three_times<float>({1.0F, 0.0F});
  has({.others = {{"NORMAL", "VEC2", 5126, two, ""}}}, "accessor 1: has too few components");
  has({.others = {{"NORMAL", "VEC3", 5126, three_times<float>({0, 0, 1}), R"(, "byteOffset": 4)"}}}, "reaches beyond");
  Attributes file;
  file.primitive = R"({"attributes": {"POSITION": 7}})";
  has(file, "refers to accessor 7, which is not there");
  file.primitive.clear();
  file.rest = R"(, "scene": 0, "scenes": [{"nodes": [3]}], "nodes": [{"mesh": 0}])";
  has(file, "refers to node 3, which is not there");
  file.rest = R"(, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 2}])";
  has(file, "refers to mesh 2, which is not there");
  // Fewer normals or colours than positions: the attribute of three elements goes with the positions of six.
  for (const char* name : {"NORMAL", "COLOR_0"}) {
    Attributes fewer;
    fewer.others = {{"_MORE", "VEC3", 5126, three_times<float>({1, 2, 3}) + three_times<float>({4, 5, 6}), ""}};
    std::string text = fewer.gltf();
    const std::string whole = R"("count": 3, "type": "VEC3")";
    text.replace(text.rfind(whole), whole.size(), R"("count": 6, "type": "VEC3")");
    text.replace(text.find(R"("POSITION": 0, "_MORE": 1)"), 25, R"("POSITION": 1, ")" + std::string(name) + R"(": 0)");
    EXPECT_NE(folder.complaint("bad.gltf", text).find("has fewer"), std::string::npos) << name;
  }
}

// A binary file whose buffer needs a view that is not there, found by fuzzing.
TEST(ReadGltf, BinaryFileWithoutAccessorsIsRefused) {
  const test::TestFolder folder;
  std::string json = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "buffers": [{"byteLength": 0}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string file = "glTF";
  for (const std::size_t word : {std::size_t{2}, 20 + json.size(), json.size(), std::size_t{0x4E4F534A}})
    put(file, static_cast<std::uint32_t>(word));
  EXPECT_NE(folder.complaint("a.glb", file + json), "accepted");
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
