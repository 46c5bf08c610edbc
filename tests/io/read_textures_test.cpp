// Texture coordinates, materials and textures of PLY and glTF files.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "io/mesh_files.h"
#include "support/wedges.h"

#ifdef OCCLOD_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace occlod {
namespace {

// The unit square as two triangles, 0 1 2 and 0 2 3.
constexpr const char* corners[] = {"0 0 0", "1 0 0", "1 1 0", "0 1 0"};

std::string ply(const std::string& comments, const std::string& vertex_properties, const std::string& vertex_values,
                const std::string& face_properties, const std::string& first, const std::string& second) {
  std::string text = "ply\nformat ascii 1.0\n" + comments +
                     "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n" + vertex_properties +
                     "element face 2\nproperty list uchar int vertex_indices\n" + face_properties + "end_header\n";
  for (const char* corner : corners) text += corner + vertex_values + "\n";
  return text + "3 0 1 2" + first + "\n3 0 2 3" + second + "\n";
}

TEST(ReadPlyTextures, TakesEveryNameOfAVertexsCoordinates) {
  const test::TestFolder folder;
  for (const auto& [u, v] : {std::pair("u", "v"), std::pair("s", "t"), std::pair("texture_u", "texture_v"),
                             std::pair("texture_s", "texture_t"), std::pair("s0", "t0")}) {
    const std::string properties =
        std::string("property float ") + v + "\nproperty uchar red\nproperty float " + u + "\n";
    const CleanMesh result = folder.read("a.ply", ply("", properties, " 0.25 9 0.5", "", "", ""));
    EXPECT_EQ(result.mesh.texture_coordinates, std::vector<glm::vec2>(4, {0.5F, 0.25F})) << u;
    ASSERT_EQ(result.report.left_out.entries().size(), 1U) << "red alone";
    EXPECT_EQ(result.report.left_out.count("property red of vertex"), 4U);
  }
}

// As MeshLab writes wedges: a seam along the diagonal, where vertex 2 differs, and two textures.
TEST(ReadPlyTextures, TakesThoseOfFaces) {
  const test::TestFolder folder;
  const std::string lists = "property list uchar float texcoord\nproperty int texnumber\n";
  const CleanMesh result = folder.read("a.ply", ply("comment TextureFile a b.png\ncomment TextureFile maps\\b.png\n",
                                                    "", "", lists, " 6 0 0 1 0 1 1 0", " 6 0 0 0.5 0.5 0 1 1"));
  EXPECT_EQ(test::wedge_problem(result.mesh), "");
  ASSERT_EQ(result.mesh.textures.size(), 2U);
  EXPECT_EQ(result.mesh.textures[0].file, "a b.png");
  EXPECT_EQ(result.mesh.textures[1].file, "maps/b.png");
  EXPECT_EQ(result.mesh.materials.at(1).texture, 1U);
  EXPECT_EQ(result.mesh.triangle_materials, (std::vector<MaterialId>{0, 1}));
  EXPECT_EQ(result.mesh.extra_wedges, (std::vector<VertexId>{0, 2}));  // by their materials
  const WedgeId second = result.mesh.corners[1].y;
  EXPECT_EQ(result.mesh.texture_coordinates[second], glm::vec2(0.5F, 0.5F));
  EXPECT_EQ(result.report.vertices_read, 4U);
  EXPECT_EQ(result.report.vertices_welded, 0U);
  EXPECT_EQ(result.report.left_out, LeftOut{});
  // One texture; the second face has none, and no coordinates.
  const CleanMesh bare =
      folder.read("b.ply", ply("comment TextureFile a.png\n", "", "", lists, " 6 0 0 1 0 1 1 0", " 0 -1"));
  EXPECT_EQ(bare.mesh.triangle_materials, (std::vector<MaterialId>{0, 1}));
  EXPECT_EQ(bare.mesh.materials.at(1).texture, no_texture);
}

TEST(ReadPlyTextures, SaysWhatIsWrong) {
  const test::TestFolder folder;
  const std::string lists = "property list uchar float texcoord\nproperty int texnumber\n";
  EXPECT_CONTAINS(folder.complaint("a.ply", ply("", "", "", lists, " 6 0 0 1 0 1 1 0", " 4 0 0 1 0 0")),
                  "line 17: the list texcoord has 4 numbers for a face of 3 corners");
  EXPECT_CONTAINS(folder.complaint("a.ply", ply("comment TextureFile a.png\n", "", "", lists, " 0 0", " 0 1")),
                  "line 18: a face has texture 1, but there are 1");
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

// One triangle: 36 bytes of positions, 24 of texture coordinates (0 0, 1 0, 0 1), then what a test adds.
struct Gltf {
  std::string bytes = test::Bytes()
                          .add_point(0, 0, 0)
                          .add_point(1, 0, 0)
                          .add_point(0, 1, 0)
                          .add_point(0, 0, 1)
                          .add_point(0, 0, 1)
                          .str();
  std::string views = R"({"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24})";
  std::string accessors = R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                             {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"})";
  std::string attributes = R"("POSITION": 0, "TEXCOORD_0": 1)";
  std::string primitive_rest = R"(, "material": 0)";
  std::string rest;  // of the file, after a comma
  std::string more_buffers;

  [[nodiscard]] std::string text() const {
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {)" +
           attributes + "}" + primitive_rest + R"(}]}], "accessors": [)" + accessors + R"(], "bufferViews": [)" +
           views + R"(], "buffers": [{"byteLength": )" + std::to_string(bytes.size()) +
           R"(, "uri": "data:application/octet-stream;base64,)" + base64(bytes) + "\"}" + more_buffers + "]" + rest +
           "}";
  }
};

const char* const one_material = R"(, "materials": [{"name": "m", "alphaMode": "BLEND", "pbrMetallicRoughness": {
    "baseColorFactor": [0.5, 0.25, 2, 0.125], "baseColorTexture": {"index": 0}}}],
  "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "wrapT": 33648}])";

TEST(ReadGltfTextures, TakesMaterialsAndFiles) {
  const test::TestFolder folder;
  Gltf file;
  file.rest = std::string(one_material) + R"(, "images": [{"uri": "my%20maps/a.png"}])";
  const CleanMesh result = folder.read("a.gltf", file.text());
  ASSERT_EQ(result.mesh.materials.size(), 1U);
  EXPECT_EQ(result.mesh.materials[0].name, "m");
  EXPECT_EQ(result.mesh.materials[0].base_color, glm::vec4(0.5F, 0.25F, 1.0F, 0.125F));  // clamped
  ASSERT_EQ(result.mesh.textures.size(), 1U);
  EXPECT_EQ(result.mesh.textures[0].file, "my maps/a.png");
  EXPECT_EQ(result.mesh.textures[0].wrap_s, TextureWrap::clamp);
  EXPECT_EQ(result.mesh.textures[0].wrap_t, TextureWrap::mirror);
  EXPECT_EQ(result.mesh.texture_origin, TextureOrigin::top_left);
  EXPECT_EQ(result.mesh.texture_coordinates, (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_EQ(result.report.left_out.count("TEXCOORD_0"), 0U);
  EXPECT_TRUE(result.report.left_out.entries().empty());
}

// Bytes in a buffer view and in a data URI are kept as they are, with their kind.
TEST(ReadGltfTextures, KeepsEmbeddedImages) {
  const test::TestFolder folder;
  Gltf in_view;
  in_view.rest = std::string(one_material) + R"(, "images": [{"bufferView": 2, "mimeType": "image/jpeg"}])";
  in_view.views += R"(, {"buffer": 0, "byteOffset": 60, "byteLength": 5})";
  in_view.bytes += "image and more";
  const Texture embedded = folder.read("a.gltf", in_view.text()).mesh.textures.at(0);
  EXPECT_EQ(std::string(embedded.bytes.begin(), embedded.bytes.end()), "image");
  EXPECT_EQ(embedded.mime_type, "image/jpeg");
  EXPECT_TRUE(embedded.file.empty());
  Gltf in_uri;
  in_uri.rest =
      std::string(one_material) + R"(, "images": [{"uri": "data:image/png;base64,)" + base64("picture") + "\"}]";
  const Texture data = folder.read("b.gltf", in_uri.text()).mesh.textures.at(0);
  EXPECT_EQ(std::string(data.bytes.begin(), data.bytes.end()), "picture");
  EXPECT_EQ(data.mime_type, "image/png");
  in_view.views.replace(in_view.views.rfind("\"byteLength\": 5"), 15, "\"byteLength\": 99");
  EXPECT_CONTAINS(folder.complaint("c.gltf", in_view.text()), "image 0: reaches beyond its buffer");
}

// The example of the extension: the lower left quarter of the image, turned by a quarter. (0, 0) -> (0, 1),
// (1, 0) -> (0, 0.5), (0, 1) -> (0.5, 1).
TEST(ReadGltfTextures, AppliesTextureTransforms) {
  const test::TestFolder folder;
  Gltf file;
  file.rest = R"(, "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": {
      "KHR_texture_transform": {"offset": [0, 1], "rotation": 1.57079632679489661923, "scale": [0.5, 0.5]}}}}}],
    "textures": [{"source": 0}], "images": [{"uri": "a.png"}])";
  const std::vector<glm::vec2> found = folder.read("a.gltf", file.text()).mesh.texture_coordinates;
  const glm::vec2 expected[] = {{0, 1}, {0, 0.5F}, {0.5F, 1}};
  ASSERT_EQ(found.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found[i].x, expected[i].x, 1e-7F) << i;
    EXPECT_NEAR(found[i].y, expected[i].y, 1e-7F) << i;
  }
}

// The set that the base colour names; the other is left out. Bytes are fractions of 255.
TEST(ReadGltfTextures, TakesTheSetOfTheBaseColour) {
  const test::TestFolder folder;
  Gltf file;
  file.attributes += R"(, "TEXCOORD_1": 2)";
  file.bytes += std::string("\xff\x33\0\0\xff\x33\0\0\xff\x33\0\0", 12);
  file.views += R"(, {"buffer": 0, "byteOffset": 60, "byteLength": 12, "byteStride": 4})";
  file.accessors += R"(, {"bufferView": 2, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC2"})";
  file.rest = R"(, "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1}}}],
    "textures": [{"source": 0}], "images": [{"uri": "a.png"}])";
  const CleanMesh result = folder.read("a.gltf", file.text());
  EXPECT_EQ(result.mesh.texture_coordinates, std::vector<glm::vec2>(3, {1.0F, 0.2F}));
  EXPECT_EQ(result.report.left_out.count("TEXCOORD_0"), 3U);
}

// Colours of vertices are linear in glTF and sRGB here: 0.2140411 is 128 / 255, and alpha is as it is.
TEST(ReadGltfTextures, ColoursAreLinear) {
  const test::TestFolder folder;
  Gltf file;
  file.primitive_rest.clear();
  file.attributes = R"("POSITION": 0, "COLOR_0": 2)";
  test::Bytes colors(file.bytes);
  for (int i = 0; i < 3; ++i) colors.add(0.2158605F).add(0.0F).add(1.0F).add(0.5F);
  file.bytes = colors.str();
  file.views += R"(, {"buffer": 0, "byteOffset": 60, "byteLength": 48})";
  file.accessors += R"(, {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC4"})";
  const TriangleMesh mesh = folder.read("a.gltf", file.text()).mesh;
  EXPECT_EQ(mesh.colors, std::vector<glm::u8vec4>(3, {128, 0, 255, 128}));
  EXPECT_TRUE(mesh.materials.empty());
}

// Primitives without a material have one of their own where others have one.
TEST(ReadGltfTextures, WhatHasNoMaterialGetsOne) {
  const test::TestFolder folder;
  Gltf file;
  file.primitive_rest = R"(, "material": 0}, {"attributes": {"POSITION": 0})";
  file.rest = R"(, "materials": [{"name": "m"}, {"name": "unused"}])";
  const TriangleMesh mesh = folder.read("a.gltf", file.text()).mesh;
  ASSERT_EQ(mesh.materials.size(), 3U);
  Material usual;
  usual.surface.metallic = 1.0F;  // as glTF has it
  EXPECT_EQ(mesh.materials[2], usual);
  EXPECT_EQ(mesh.triangle_materials, (std::vector<MaterialId>{0, 2}));
}

// Position 1 is replaced by (5, 6, 7).
Gltf sparse_file(const std::string& base) {
  Gltf file;
  file.primitive_rest.clear();
  file.attributes = R"("POSITION": 0)";
  test::Bytes bytes(file.bytes);
  bytes.add(std::uint16_t{1}).add(std::uint16_t{2}).add_point(5, 6, 7).add_point(8, 9, 1);
  file.bytes = bytes.str();
  file.views +=
      R"(, {"buffer": 0, "byteOffset": 60, "byteLength": 4}, {"buffer": 0, "byteOffset": 64, "byteLength": 24})";
  file.accessors = "{" + base + R"("componentType": 5126, "count": 3, "type": "VEC3", "sparse": {"count": 2,
    "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 3}}})";
  return file;
}

TEST(ReadGltfTextures, ReadsSparseAccessors) {
  const test::TestFolder folder;
  EXPECT_EQ(folder.read("a.gltf", sparse_file(R"("bufferView": 0, )").text()).mesh.positions,
            (std::vector<glm::vec3>{{0, 0, 0}, {5, 6, 7}, {8, 9, 1}}));
  EXPECT_EQ(folder.read("b.gltf", sparse_file("").text()).mesh.positions,
            (std::vector<glm::vec3>{{0, 0, 0}, {5, 6, 7}, {8, 9, 1}}));  // zeros where there is no base
  const auto complaint = [&](const std::string& from, const std::string& to) {
    std::string text = sparse_file("").text();
    text.replace(text.find(from), from.size(), to);
    return folder.complaint("c.gltf", text);
  };
  EXPECT_CONTAINS(complaint(R"("count": 3)", R"("count": 2)"), "accessor 0: has a sparse value for element 2 of 2");
  EXPECT_CONTAINS(complaint(R"("count": 3)", R"("count": 4000000000)"),
                  "accessor 0: has 4000000000 elements without data");
  EXPECT_CONTAINS(complaint(R"("count": 2)", R"("count": 99)"), "accessor 0: reaches beyond its buffer");
  EXPECT_CONTAINS(complaint(R"("componentType": 5123)", R"("componentType": 5126)"),
                  "sparse indices of an unknown type");
  EXPECT_CONTAINS(complaint(R"({"bufferView": 3})", R"({"bufferView": 9})"), "accessor 0: has no data");
}

TEST(ReadGltfTextures, SaysWhatIsWrong) {
  const test::TestFolder folder;
  const auto complaint = [&](const std::string& rest, const std::string& primitive) {
    Gltf file;
    file.rest = rest;
    file.primitive_rest = primitive;
    return folder.complaint("a.gltf", file.text());
  };
  const std::string use = R"(, "material": 0)";
  EXPECT_CONTAINS(complaint(R"(, "materials": [{}])", R"(, "material": 7)"), "refers to material 7");
  EXPECT_CONTAINS(complaint(one_material, use), "refers to image 0");
  EXPECT_CONTAINS(complaint(R"(, "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 3}}}])", use),
                  "refers to texture 3");
  EXPECT_CONTAINS(complaint("", R"(, "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0}})"), "Draco");
  EXPECT_CONTAINS(complaint(R"(, "extensionsRequired": ["KHR_draco_mesh_compression"])", ""), "Draco");
}

#ifdef OCCLOD_HAS_MESHOPTIMIZER

// A grid with its positions, normals and indices compressed: view 0, 1 and 2 of a buffer that is not there.
struct CompressedGrid {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
  std::string compressed[3];

  CompressedGrid() {
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 20; ++x) positions.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.25F);
    for (std::uint32_t y = 0; y < 19; ++y) {
      for (std::uint32_t x = 0; x < 19; ++x) {
        const std::uint32_t a = 20 * y + x;
        for (const std::uint32_t i : {a, a + 1, a + 21, a, a + 21, a + 20}) indices.push_back(i);
      }
    }
    const auto encode = [](std::string& to, std::size_t bound, auto encoder) {
      to.resize(bound);
      to.resize(encoder(reinterpret_cast<unsigned char*>(to.data()), bound));
    };
    encode(compressed[0], meshopt_encodeVertexBufferBound(positions.size(), 12), [&](unsigned char* to, std::size_t n) {
      return meshopt_encodeVertexBuffer(to, n, positions.data(), positions.size(), 12);
    });
    // Octahedral normals of 8 bits: x, y, the length 127 and 0 stand for (0, 0, 1).
    const std::vector<std::uint32_t> normals(positions.size(), 0x007f0000U);
    encode(compressed[1], meshopt_encodeVertexBufferBound(normals.size(), 4), [&](unsigned char* to, std::size_t n) {
      return meshopt_encodeVertexBuffer(to, n, normals.data(), normals.size(), 4);
    });
    encode(compressed[2], meshopt_encodeIndexBufferBound(indices.size(), positions.size()),
           [&](unsigned char* to, std::size_t n) {
             return meshopt_encodeIndexBuffer(to, n, indices.data(), indices.size());
           });
  }

  [[nodiscard]] std::string text() const {
    Gltf file;
    file.bytes.clear();
    file.views.clear();
    const char* const layouts[] = {R"("byteStride": 12, "count": 400, "mode": "ATTRIBUTES")",
                                   R"("byteStride": 4, "count": 400, "mode": "ATTRIBUTES", "filter": "OCTAHEDRAL")",
                                   R"("byteStride": 4, "count": 2166, "mode": "TRIANGLES")"};
    for (int i = 0; i < 3; ++i) {
      file.views +=
          std::string(i == 0 ? "" : ", ") +
          R"({"buffer": 1, "byteLength": 1600, "extensions": {"EXT_meshopt_compression": {"buffer": 0, "byteOffset": )" +
          std::to_string(file.bytes.size()) + R"(, "byteLength": )" + std::to_string(compressed[i].size()) + ", " +
          layouts[i] + "}}}";
      file.bytes += compressed[i];
    }
    file.accessors = R"({"bufferView": 0, "componentType": 5126, "count": 400, "type": "VEC3"},
      {"bufferView": 1, "componentType": 5120, "normalized": true, "count": 400, "type": "VEC3"},
      {"bufferView": 2, "componentType": 5125, "count": 2166, "type": "SCALAR"})";
    file.attributes = R"("POSITION": 0, "NORMAL": 1)";
    file.primitive_rest = R"(, "indices": 2)";
    file.more_buffers = R"(, {"byteLength": 20000, "extensions": {"EXT_meshopt_compression": {"fallback": true}}})";
    file.rest = R"(, "extensionsRequired": ["EXT_meshopt_compression"])";
    return file.text();
  }
};

TEST(ReadCompressedGltf, GivesBackWhatWasCompressed) {
  const test::TestFolder folder;
  const CompressedGrid grid;
  const TriangleMesh mesh = folder.read("a.gltf", grid.text()).mesh;
  EXPECT_EQ(mesh.positions, grid.positions);
  EXPECT_EQ(mesh.normals, std::vector<glm::vec3>(400, {0, 0, 1}));
  ASSERT_EQ(mesh.triangle_count(), grid.indices.size() / 3);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    // The codec may turn a triangle's corners round.
    Triangle turned(grid.indices[3 * t], grid.indices[3 * t + 1], grid.indices[3 * t + 2]);
    for (int i = 0; i < 2 && turned != mesh.triangles[t]; ++i) turned = {turned.y, turned.z, turned.x};
    EXPECT_EQ(mesh.triangles[t], turned) << t;
  }
}

// The same in a binary file, whose own chunk is the first buffer.
TEST(ReadCompressedGltf, ReadsBinaryFiles) {
  const test::TestFolder folder;
  const CompressedGrid grid;
  std::string json = grid.text(), chunk;
  for (const std::string& part : grid.compressed) chunk += part;
  const std::size_t uri = json.find(R"(, "uri": "data:)");
  json.erase(uri, json.find("\"}", uri) + 1 - uri);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  chunk.resize((chunk.size() + 3) / 4 * 4, '\0');
  test::Bytes file("glTF");
  file.add(std::uint32_t{2}).add(static_cast<std::uint32_t>(28 + json.size() + chunk.size()));
  file.add(static_cast<std::uint32_t>(json.size())).add(std::uint32_t{0x4E4F534A});
  test::Bytes rest(file.str() + json);
  rest.add(static_cast<std::uint32_t>(chunk.size())).add(std::uint32_t{0x004E4942});
  EXPECT_EQ(folder.read("a.glb", rest.str() + chunk).mesh.positions, grid.positions);
}

TEST(ReadCompressedGltf, RefusesWhatIsCutOrDamaged) {
  const test::TestFolder folder;
  for (int part = 0; part < 3; ++part) {
    for (const std::size_t left : {std::size_t{0}, std::size_t{1}, std::size_t{20}}) {
      CompressedGrid grid;
      grid.compressed[part].resize(left);
      EXPECT_CONTAINS(folder.complaint("a.gltf", grid.text()), "buffer view " + std::to_string(part) + ": ") << left;
    }
  }
  const auto complaint = [&](const std::string& from, const std::string& to) {
    std::string text = CompressedGrid().text();
    text.replace(text.find(from), from.size(), to);
    return folder.complaint("a.gltf", text);
  };
  EXPECT_CONTAINS(complaint("ATTRIBUTES", "OTHER"), "mode or byteStride");
  EXPECT_CONTAINS(complaint(R"("byteStride": 12)", R"("byteStride": 13)"), "mode or byteStride");
  EXPECT_CONTAINS(complaint("OCTAHEDRAL", "QUATERNION"), "filter that does not fit");
  EXPECT_CONTAINS(complaint(R"("byteStride": 12, "count": 400)", R"("byteStride": 12, "count": 2000000000)"),
                  "promises more");
  EXPECT_CONTAINS(complaint(R"("count": 2166, "mode")", R"("count": 2165, "mode")"), "promises more");
  EXPECT_CONTAINS(complaint(R"("byteOffset": 0)", R"("byteOffset": 99999)"), "reaches beyond its buffer");
}

#endif

}  // namespace
}  // namespace occlod
