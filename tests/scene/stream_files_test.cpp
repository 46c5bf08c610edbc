// PLY and OBJ files that are streamed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "hlod/hlod_bytes.h"
#include "mesh/stream_mesh.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/mesh_file.h"
#include "occlod/scene.h"
#include "scene_folder.h"
#include "support/meshes.h"
#include "support/wedge_meshes.h"

namespace occlod {
namespace {

hlod::TriangleSource stream(const std::string& file) {
  SceneDescription scene;
  scene.name = file;
  scene.objects.emplace_back().source = MeshFile{{file}};
  return stream_scene(scene, "");
}

std::string built(const hlod::TriangleSource& source) {
  hlod::HlodBuildOptions options;
  options.node_triangles = 64;
  MeshReport report;
  return hlod::test::bytes_of(build_hlod(source, options, report));
}

// The mesh as read_mesh() has it, to the bit.
std::string built_whole(const std::string& file) {
  const TriangleMesh mesh = read_mesh(file).mesh;
  return built([&](hlod::TriangleSink& sink) { sink.add(mesh); });
}

// What the file makes either way; empty where it makes the same.
std::string difference(const std::string& file) {
  return built(stream(file)) == built_whole(file) ? "" : file + " is built otherwise";
}

// n x n quads. `corner` says what follows a vertex index on a line of a face.
template <class CornerOf>
std::string obj_faces(int n, const CornerOf& corner) {
  std::string text;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int v = y * (n + 1) + x + 1;
      text += "f";
      for (const int c : {v, v + 1, v + n + 2, v + n + 1}) text += fmt::format(" {}{}", c, corner(c, x, y));
      text += "\n";
    }
  return text;
}

std::string obj_vertices(int n, const std::string& more = "") {
  std::string text;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) text += fmt::format("v {} {} {}{}\n", x, y, 0.25 * std::sin(x + y), more);
  return text;
}

class StreamedFiles : public test::SceneFolder {
 protected:
  [[nodiscard]] std::string file(const std::string& name, const std::string& content) const {
    return write(name, content).string();
  }
  [[nodiscard]] static std::string refusal(const std::string& name) {
    try {
      (void)built(stream(name));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  [[nodiscard]] static std::string refusal_whole(const std::string& name) {
    try {
      (void)read_mesh(name);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(StreamedFiles, MakeWhatTheirMeshesMake) {
  TriangleMesh colored = test::noisy_sphere(3, 1);
  for (const glm::vec3& p : colored.positions) {
    colored.colors.emplace_back(static_cast<std::uint8_t>(100.0F + 90.0F * p.x), 20, 30, 255);
    colored.normals.push_back(3.0F * p);
  }
  TriangleMesh striped = test::grid_of_charts(
      16, [](int i, int) { return i / 8; }, [](int i, int) { return i / 8; });
  striped.materials.resize(2);
  striped.textures.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    striped.textures[i].file = fmt::format("{}.png", i);
    striped.materials[i] = {.name = fmt::format("m{}", i), .texture = static_cast<TextureId>(i)};
  }
  std::vector<TriangleMesh> meshes = {test::noisy_sphere(4, 1),         test::book(40),         colored, striped,
                                      test::cylinder_with_seam(48, 24), test::cube_of_charts(8)};
  for (std::uint64_t seed = 0; seed < 10; ++seed) meshes.push_back(test::random_soup_with_wedges(seed));
  for (std::size_t i = 0; i < meshes.size(); ++i)
    for (const char* const extension : {"ply", "obj"}) {
      const std::string name = (folder() / fmt::format("{}.{}", i, extension)).string();
      write_mesh(name, meshes[i]);
      EXPECT_EQ(difference(name), "");
    }
}

// Two groups, a normal and two texture coordinates that no face uses, and one at the corner of a face that is not
// finite.
TEST_F(StreamedFiles, CountWhatIsLeftOut) {
  const auto corner = [](int c, int, int) { return c == 1 ? "/2/1" : "/1/1"; };
  const std::string name =
      file("left_out.obj", obj_vertices(4) + "vn 0 0 1\nvn 1 0 0\nvt 0 0\nvt nan 0\nvt 1 1\nvt 2 2\ng a\n" +
                               obj_faces(4, corner) + "g b\n");
  hlod::HlodBuildOptions options;
  options.node_triangles = 64;
  MeshReport report;
  static_cast<void>(build_hlod(stream(name), options, report));
  EXPECT_EQ(report.left_out.entries().size(), 4u);
  EXPECT_EQ(report.left_out, read_mesh(name).report.left_out);
}

// Materials that scale and move their textures, by turns and on quads.
TEST_F(StreamedFiles, TexturesAreAtTheSamePlaces) {
  static_cast<void>(
      write("placed.mtl", "newmtl a\nmap_Kd -s 2 3 t.png\nnewmtl b\nmap_Kd -o 0.5 0.25 t.png\nnewmtl c\n"));
  const auto textured = [](int c, int, int) { return fmt::format("/{}", c % 5 + 1); };
  std::string text = "mtllib placed.mtl\n" + obj_vertices(12) + "vt 0 0\nvt 1 0\nvt 0.5 0.5\nvt 0 1\nvt 1 1\n";
  for (const char* const material : {"a", "b", "a", "c", "b"})
    text += fmt::format("usemtl {}\n", material) + obj_faces(12, textured);
  const std::string placed = file("placed.obj", text);
  EXPECT_EQ(difference(placed), "");
  const std::string before = built(stream(placed));
  static_cast<void>(write("placed.mtl", "newmtl a\nmap_Kd t.png\nnewmtl b\nmap_Kd t.png\nnewmtl c\n"));
  EXPECT_NE(built(stream(placed)), before) << "or they are not placed";
}

TEST_F(StreamedFiles, NormalsWithoutADirectionAreThoseOfTheSurface) {
  const std::string normals = "vn 0 0 2\nvn 0 0 0\nvn 1 0 1\n";
  const auto mixed = [](int, int x, int y) {
    return x % 3 == 0 ? std::string("//2") : (x + y) % 2 == 0 ? std::string("//1") : std::string("//3");
  };
  EXPECT_EQ(difference(file("zero.obj", obj_vertices(20) + normals + obj_faces(20, mixed))), "");
  const auto some = [](int, int x, int) { return x < 10 ? std::string("//1") : std::string(); };
  EXPECT_EQ(difference(file("some.obj", obj_vertices(20) + normals + obj_faces(20, some))), "");
}

TEST_F(StreamedFiles, WhatCleaningDropsIsDropped) {
  const auto bare = [](int, int, int) { return std::string(); };
  const std::string sheet = obj_faces(12, bare);
  EXPECT_EQ(difference(file("degenerate.obj", "f 1 2 2\nf 170 1 171\nf 30 31 30\n" + sheet + obj_vertices(12) +
                                                  "v 0 0 0\nv 0 0 0\nf 1 170 2\nv nan 0 0\n")),
            "")
      << "faces come first, two are of one place";
  EXPECT_EQ(difference(
                file("textures.obj", obj_vertices(12) + "vt nan 0\nvt 0.5 0.5\nvt 0 1\n" +
                                         obj_faces(12, [](int, int x, int) { return fmt::format("/{}", x % 3 + 1); }))),
            "");
  EXPECT_EQ(difference(file("materials.obj", obj_vertices(12, " 0.5 0.25 1") + sheet + "usemtl a\n" + sheet +
                                                 "usemtl b\nf 1 1 2\nf 1 15 30\n")),
            "");
}

// The corners of all triangles.
struct Corners : hlod::TriangleSink {
  std::vector<glm::vec3> all;
  std::size_t pieces = 0;
  void add(const TriangleMesh& piece) override {
    ++pieces;
    for (const Triangle& t : piece.wedge_triangles())
      for (int k = 0; k < 3; ++k) all.push_back(piece.positions[t[k]]);
  }
};

TEST(StreamedGenerators, GiveTheTrianglesOfTheWhole) {
  SceneDescription scene;
  scene.objects.resize(4);
  scene.objects[0].source = GeneratedMesh{"city", {{"facade_cells", 6}}};
  scene.objects[1].source = GeneratedMesh{"pipes", {}};
  scene.objects[2].source = GeneratedMesh{"plant", {{"storeys", 1}, {"bays", 1}, {"pipes", 4}}};
  scene.objects[3].source = GeneratedMesh{"spheres-behind-wall", {{"spheres", 20}}};
  for (std::size_t i = 0; i < 4; ++i) scene.objects[i].object_to_world[3].x = 2000.0 * static_cast<double>(i);
  Corners streamed, whole;
  stream_scene(scene, "")(streamed);
  whole.add(flatten_scene(scene, "").mesh);
  EXPECT_EQ(streamed.all, whole.all);
  EXPECT_EQ(streamed.pieces, 5U) << "the city makes two";
}

// Before the scene turns them over for other objects with another origin.
TEST_F(StreamedFiles, TextureCoordinatesThatAreNotFiniteAreZero) {
  const StreamedMesh mesh(file("nan.obj", obj_vertices(1) + "vt nan 0.5\nvt 0.25 0.5\nf 1/1 2/2 3/2\n"), {});
  std::vector<glm::vec2> coordinates;
  mesh.visit(1, [&](const TriangleMesh& piece) { coordinates = piece.texture_coordinates; });
  EXPECT_EQ(coordinates, (std::vector<glm::vec2>{{0, 0}, {0.25F, 0.5F}, {0.25F, 0.5F}}));
}

TEST_F(StreamedFiles, StripsAndTextInUtf16) {
  std::string strips =
      "ply\nformat ascii 1.0\nelement vertex 60\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  for (int i = 0; i < 60; ++i) strips += fmt::format("{} {} {}\n", i / 2, i % 2, i % 7);
  strips += "63";
  for (int i = 0; i < 30; ++i) strips += fmt::format(" {}", i);
  strips += " -1 30";
  for (int i = 30; i < 60; ++i) strips += fmt::format(" {}", i);
  strips += " -1\n";
  EXPECT_EQ(difference(file("strips.ply", strips)), "");
  std::string wide = "\xff\xfe";
  for (const char c : obj_vertices(6) + obj_faces(6, [](int, int, int) { return std::string(); })) {
    wide += c;
    wide += '\0';
  }
  EXPECT_EQ(difference(file("wide.obj", wide)), "");
}

// Lines of which a block of the file may end in the middle.
TEST_F(StreamedFiles, LinesOverTheEndsOfBlocksAreWhole) {
  for (const std::string line_end : {"\n", "\r\n", "\r"}) {
    std::string text;
    constexpr int count = 150'000;
    for (int i = 0; i < count; ++i)
      text += fmt::format("v {} \\{}{}\\{} {}{}", i % 1000, line_end, i / 1000, line_end, i % 7, line_end);
    ASSERT_GT(text.size(), std::size_t{2} << 20U);
    text += "f 1 2 1001 \\" + line_end + " 77";
    const std::string good = file("long.obj", text + line_end), bad = file("bad.obj", text + " x" + line_end);
    EXPECT_EQ(difference(good), "") << "ends of " << line_end.size();
    EXPECT_EQ(read_mesh(good).report.vertices_read, std::uint64_t{count});
    EXPECT_NE(refusal(bad).find(fmt::format("line {}:", 3 * count + 2)), std::string::npos) << refusal(bad);
    EXPECT_EQ(refusal(bad), refusal_whole(bad));
  }
}

TEST_F(StreamedFiles, AreRefusedAsAWhole) {
  const std::string start = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::vector<std::pair<std::string, std::string>> files = {
      {"missing.obj", start + "f 1 2 4\n"},
      {"none.obj", start},
      {"flat.obj", start + "f 1 1 2\n"},
      {"far.obj", start + "v 1e38 0 0\nf 1 2 4\n"},
      {"nan.obj", start + "v nan 0 0\nf 1 2 4\n"},
      {"word.obj", start + "f 1 2 three\n"},
      {"line.obj", start + "f 1 2\n"},
      {"short.ply", header + "0 0 0\n1 0 0\n0 1 0\n"},
      {"cut.ply", header + "0 0 0\n1 0 0\n0 1"},
      {"header.ply", "ply\nformat ascii 1.0\n"},
  };
  for (const auto& [name, content] : files) {
    const std::string path = file(name, content);
    EXPECT_NE(refusal(path), "") << name;
    EXPECT_EQ(refusal(path), refusal_whole(path));
    EXPECT_EQ(refusal(path).find('\n'), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace occlod
