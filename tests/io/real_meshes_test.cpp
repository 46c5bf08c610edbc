// Meshes as people have them. Their counts come from another program; see the list that lies beside the meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <sstream>

#include "io/mesh_files.h"
#include "support/test_meshes.h"
#include "support/wedges.h"

namespace occlod {
namespace {

// A row of MANIFEST.tsv with the topology after exact welding.
struct Listed {
  std::string file;
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::map<std::string, std::uint64_t> topology;
};

// The last group "bnd 1, nmE 2, ..." of the topology column.
std::map<std::string, std::uint64_t> parse_topology(const std::string& text) {
  std::map<std::string, std::uint64_t> result;
  std::istringstream words(text.substr(std::min(text.rfind("bnd "), text.size())));
  std::string key;
  std::uint64_t value = 0;
  while (words >> key >> value) {
    result[key] = value;
    words.ignore(1);
  }
  return result;
}

std::vector<Listed> read_list(const std::filesystem::path& path, const std::string& kind) {
  std::vector<Listed> list;
  std::ifstream stream(path);
  for (std::string line; std::getline(stream, line);) {
    std::vector<std::string> columns;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, '\t');) columns.push_back(field);
    // The GLB was counted with world positions in double precision, where one weld more happens; read_gltf_test
    // compares it.
    if (columns.size() < 8 || columns[0] != kind || columns[4] == "GLB") continue;
    list.push_back({columns[1], std::stoull(columns[5]), std::stoull(columns[6]), parse_topology(columns[7])});
  }
  return list;
}

// The list counts components over shared edges, the report over shared vertices.
std::uint64_t components_over_edges(const TriangleMesh& mesh) {
  std::vector<std::size_t> root(mesh.triangle_count());
  for (std::size_t t = 0; t < root.size(); ++t) root[t] = t;
  const auto find = [&](std::size_t t) {
    while (root[t] != t) t = root[t] = root[root[t]];
    return t;
  };
  std::uint64_t count = root.size();
  std::map<std::pair<VertexId, VertexId>, std::size_t> owner;
  for (std::size_t t = 0; t < root.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3]);
      const std::size_t other = find(owner.try_emplace({low, high}, t).first->second);
      if (other != find(t)) --count;
      root[find(t)] = other;
    }
  }
  return count;
}

void expect_listed_counts(const Listed& listed, const std::filesystem::path& path) {
  SCOPED_TRACE(listed.file);
  const CleanMesh result = read_mesh(path);
  const MeshReport& r = result.report;
  const bool stl = std::tolower(path.extension().string().back()) == 'l';  // the list has STL after welding
  EXPECT_EQ(stl ? result.mesh.vertex_count() : r.vertices_read, listed.vertices);
  EXPECT_EQ(r.triangles_read, listed.triangles);
  EXPECT_EQ(r.boundary_edges, listed.topology.at("bnd"));
  EXPECT_EQ(r.nonmanifold_edges, listed.topology.at("nmE"));
  EXPECT_EQ(r.nonmanifold_vertices, listed.topology.at("nmV"));
  EXPECT_EQ(r.inconsistent_edges, listed.topology.at("incons"));
  EXPECT_EQ(r.repeated_triangles, listed.topology.at("dupT"));
  EXPECT_EQ(components_over_edges(result.mesh), listed.topology.at("comp"));
  EXPECT_LE(r.components, listed.topology.at("comp"));
  EXPECT_EQ(r.triangles_read - r.repeated_index_triangles, result.mesh.triangle_count());
}

TEST(RealMeshes, HaveTheListedCounts) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(list, "MANIFEST.tsv");
  int checked = 0;
  for (const char* kind : {"scans", "scenes"}) {
    for (const Listed& listed : read_list(list, kind)) {
      expect_listed_counts(listed, list.parent_path() / listed.file);
      ++checked;
    }
  }
  EXPECT_GT(checked, 15);
}

// Wedges by the meshes' own numbers: pairs of different positions and texture coordinates, less positions.
TEST(RealMeshes, KeepTheirSeams) {
  struct Expected {
    const char* file;
    std::size_t extra_wedges;
  };
  for (const auto& [file, extra_wedges] : {Expected{"textured/spot.obj", 295}, Expected{"textured/beast.obj", 1652}}) {
    OCCLOD_FIND_TEST_MESH_OR_SKIP(path, file);
    const CleanMesh result = read_mesh(path);
    EXPECT_EQ(test::wedge_problem(result.mesh), "") << file;
    EXPECT_EQ(result.mesh.extra_wedges.size(), extra_wedges) << file;
    EXPECT_EQ(result.report.left_out.count("texture coordinates that are not finite"), 0u) << file;
  }
}

TEST(RealMeshes, HardOnesAreReadOrRefusedInOneLine) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(folder, "hard");
  int files = 0;
  int refused = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    ++files;
    try {
      const TriangleMesh mesh = read_mesh(entry.path()).mesh;
      EXPECT_GT(mesh.triangle_count(), 0u);
      EXPECT_EQ(test::wedge_problem(mesh), "") << entry.path();
    } catch (const Error& error) {
      ++refused;
      EXPECT_EQ(error.diagnosis().subject, entry.path().string());
      EXPECT_FALSE(error.diagnosis().problem.empty());
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
  EXPECT_GT(files, 100);
  EXPECT_LT(refused, files);
}

// These have no fault that keeps them from being meshes; the ones they sit beside are refused for a reason.
TEST(RealMeshes, HardOnesThatAreSoundAreRead) {
  OCCLOD_FIND_TEST_MESH_OR_SKIP(hard, "hard");
  for (const char* name :
       {"draco__test_extra_whitespace.ply", "assimp__cube_binary_header_with_RN_newline.ply", "trimesh__comments.off",
        "assimp__box_without_lineending.obj", "numpy-stl__dos.stl", "assimp__triangle_with_two_solids.stl",
        "tinyobjloader__cube-vertex-w-component.obj", "trimesh__negative_indices.obj", "draco__extra_vertex.obj"}) {
    EXPECT_NO_THROW(static_cast<void>(read_mesh(hard / name))) << name;
  }
  for (const char* name : {"draco__inf_nan.obj", "assimp__malformed.obj", "tinyobjloader__issue-140-zero-face-idx.obj",
                           "tinyobjloader__line-prim.obj", "assimp__invalid.off", "trimesh__points_emptyface.ply"}) {
    EXPECT_THROW(static_cast<void>(read_mesh(hard / name)), Error) << name;
  }
}

}  // namespace
}  // namespace occlod
