// What no file may do: crash the reader, make it invent geometry, or fail without saying where.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <tuple>

#include "io/mesh_files.h"
#include "mesh/polygon_soup.h"
#include "occlod/mesh_file.h"
#include "support/meshes.h"

namespace occlod {
namespace {

using Corners = std::array<glm::vec3, 3>;

bool less(const glm::vec3& a, const glm::vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }
struct CornersLess {
  bool operator()(const Corners& a, const Corners& b) const {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), less);
  }
};

std::multiset<Corners, CornersLess> triangles_of(const TriangleMesh& mesh) {
  std::multiset<Corners, CornersLess> result;
  for (const Triangle& t : mesh.triangles) {
    result.insert({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]});
  }
  return result;
}

// read_mesh() without the file, for the many inputs of these tests.
TriangleMesh read_bytes(const std::string& name, std::string_view bytes) {
  const FileErrors errors(name);
  InputBytes input(bytes);
  PolygonSoup soup = parse_mesh(format_of(name, errors), input, errors);
  MeshReport report;
  TriangleMesh mesh = take_mesh(soup, report, errors);
  return clean(std::move(mesh), report, name).mesh;
}

// One digit a number, so that a number cut short is a number missing: 4 vertices and 4 triangles.
const char* const small_obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const char* const small_off = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const char* const small_ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const char* const small_stl =
    "solid s\n"
    "facet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n"
    "facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n"
    "facet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\n"
    "facet normal 1 1 1\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n"
    "endsolid s\n";

// The same as one strip: (0 2 1), (2 3 1), (1 3 0), (3 2 0).
const char* const small_strips =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n7 0 2 1 3 0 2 -1\n";

struct Sample {
  std::string name;
  std::string bytes;
  bool says_where_it_ends;  // by counts or an end mark; OBJ does neither, so a shorter file can be a whole smaller mesh
};

std::vector<Sample> samples(const test::TestFolder& folder) {
  std::vector<Sample> result = {{"a.obj", small_obj, false},
                                {"a.off", small_off, true},
                                {"a.ply", small_ply, true},
                                {"a.stl", small_stl, true},
                                {"c.ply", small_strips, true}};
  TriangleMesh mesh = test::tetrahedron();
  for (const char* name : {"b.stl", "b.ply"}) {
    write_mesh(folder.path() / name, mesh);
    result.push_back({name, test::bytes_of(folder.path() / name), true});
  }
  return result;
}

TEST(BadInput, TruncationAtEveryByteGivesAnErrorOrAPrefix) {
  const test::TestFolder folder;
  for (const Sample& sample : samples(folder)) {
    const auto whole = triangles_of(read_bytes(sample.name, sample.bytes));
    ASSERT_EQ(whole.size(), 4u) << sample.name;
    for (std::size_t size = 1; size < sample.bytes.size(); ++size) {
      try {
        const auto part = triangles_of(read_bytes(sample.name, sample.bytes.substr(0, size)));
        EXPECT_TRUE(std::includes(whole.begin(), whole.end(), part.begin(), part.end(), CornersLess()))
            << sample.name << " cut to " << size << " bytes";
        EXPECT_TRUE(part.size() == 4 || !sample.says_where_it_ends) << sample.name << " cut to " << size << " bytes";
      } catch (const Error& error) {
        EXPECT_EQ(error.diagnosis().subject, sample.name);
      }
    }
  }
}

// Seeded mutations: whatever comes out is a mesh that holds what it promises, or one Error.
TEST(BadInput, MutatedFilesAreReadOrRefused) {
  const test::TestFolder folder;
  std::mt19937 random(11);
  for (const Sample& sample : samples(folder)) {
    for (int round = 0; round < 5000; ++round) {
      std::string bytes = sample.bytes;
      for (unsigned change = 0; change < 1 + random() % 4; ++change) {
        const std::size_t at = random() % bytes.size();
        switch (random() % 4) {
          case 0:
            bytes[at] = static_cast<char>(random());
            break;
          case 1:
            bytes[at] = "0123456789-+.e/\\# \n\r"[random() % 20];
            break;
          case 2:
            bytes.erase(at, 1 + random() % 5);
            break;
          default:
            bytes.insert(at, bytes.substr(random() % bytes.size(), random() % 9));
            break;
        }
        if (bytes.empty()) bytes = "\n";
      }
      try {
        const TriangleMesh mesh = read_bytes(sample.name, bytes);
        for (const Triangle& t : mesh.triangles) {
          ASSERT_LT(std::max({t.x, t.y, t.z}), mesh.vertex_count());
          ASSERT_TRUE(t.x != t.y && t.y != t.z && t.z != t.x);
        }
        for (const glm::vec3& p : mesh.positions) ASSERT_TRUE(std::isfinite(p.x + 0 * p.y + 0 * p.z));
      } catch (const Error& error) {
        ASSERT_FALSE(error.diagnosis().problem.empty());
      }
    }
  }
}

TEST(BadInput, NamesFilesThatCannotBeRead) {
  const test::TestFolder folder;
  const auto problem = [&](const std::filesystem::path& path) {
    try {
      static_cast<void>(read_mesh(path));
    } catch (const Error& error) {
      EXPECT_EQ(error.diagnosis().subject, path.string());
      return error.diagnosis().problem;
    }
    return std::string("accepted");
  };
  EXPECT_EQ(problem(folder.path() / "none.ply"), "no such file");
  std::filesystem::create_directory(folder.path() / "folder.ply");
  EXPECT_EQ(problem(folder.path() / "folder.ply"), "is a folder");
  EXPECT_EQ(problem(folder.path() / "a.fbx"), "the extension '.fbx' is unknown");
  EXPECT_EQ(problem(folder.path() / "ply"), "has no extension");
  for (const char* name : {"a.ply", "a.obj", "a.off", "a.stl", "a.gltf", "a.glb"}) {
    EXPECT_EQ(problem(folder.write(name, "")), "is empty");
    EXPECT_NE(problem(folder.write(name, "\n\n \n")), "accepted");
    EXPECT_NE(problem(folder.write(name, std::string(300, '\0'))), "accepted");
  }
  std::filesystem::create_symlink("/dev/zero", folder.path() / "zero.stl");
  EXPECT_EQ(problem(folder.path() / "zero.stl"), "is not a regular file");
}

TEST(BadInput, MessagesAreOnePrintableLine) {
  const test::TestFolder folder;
  const std::string said = folder.complaint("a.obj", "v 0 0 \x1b[31m\xff" + std::string(500, 'x') + "\n");
  EXPECT_LT(said.size(), 200u);
  for (const char c : said) EXPECT_TRUE(c >= ' ' && c <= '~');
}

}  // namespace
}  // namespace occlod
