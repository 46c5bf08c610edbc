#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "io/mesh_files.h"
#include "occlod/mesh_file.h"
#include "support/meshes.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

// Coordinates whose shortest decimals are long, tiny or huge: text must bring back the same bits.
TriangleMesh awkward_mesh() {
  TriangleMesh mesh = test::noisy_sphere(2, 3);
  mesh.positions[0] = {1.0f / 3.0f, std::numeric_limits<float>::denorm_min(),
                       std::nextafter(farthest_coordinate, 0.0f)};
  mesh.positions[1] = {-16777216.0f, 1e-30f, 0.1f};
  return mesh;
}

TEST(WriteMesh, IndexedFormatsBringBackTheSameMesh) {
  const test::TestFolder folder;
  const TriangleMesh mesh = awkward_mesh();
  for (const char* name : {"a.ply", "a.obj", "a.off", "A.PLY", "A.Obj", "a.glb"}) {
    write_mesh(folder.path() / name, mesh);
    const CleanMesh back = read_mesh(folder.path() / name);
    EXPECT_EQ(back.mesh.positions, mesh.positions) << name;
    EXPECT_EQ(back.mesh.triangles, mesh.triangles) << name;
  }
}

TEST(WriteMesh, StlBringsBackTheSameTriangles) {
  const test::TestFolder folder;
  const TriangleMesh mesh = awkward_mesh();
  write_mesh(folder.path() / "a.stl", mesh);
  EXPECT_EQ(fs::file_size(folder.path() / "a.stl"), 84 + 50 * mesh.triangle_count());
  const TriangleMesh back = read_mesh(folder.path() / "a.stl").mesh;
  ASSERT_EQ(back.triangle_count(), mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      EXPECT_EQ(back.positions[back.triangles[t][corner]], mesh.positions[mesh.triangles[t][corner]]);
    }
  }
}

TEST(WriteMesh, StlFacetsPointOutward) {
  const test::TestFolder folder;
  write_mesh(folder.path() / "a.stl", test::grid(1, 1));
  const std::string bytes = test::bytes_of(folder.path() / "a.stl");
  EXPECT_EQ(bytes.substr(84, 12), test::Bytes().add_point(0, 0, 1).str());
}

TEST(WriteMesh, PlyCarriesNormalsAndColours) {
  const test::TestFolder folder;
  TriangleMesh mesh = test::tetrahedron();
  mesh.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0.6f, 0, 0.8f}};
  mesh.colors = {{0, 1, 2, 3}, {255, 254, 253, 252}, {7, 7, 7, 7}, {9, 0, 0, 255}};
  write_mesh(folder.path() / "a.ply", mesh);
  const TriangleMesh back = read_mesh(folder.path() / "a.ply").mesh;
  EXPECT_EQ(back.colors, mesh.colors);
  ASSERT_EQ(back.normals.size(), 4u);
  for (std::size_t v = 0; v < 4; ++v) {
    for (int i = 0; i < 3; ++i) EXPECT_FLOAT_EQ(back.normals[v][i], mesh.normals[v][i]);
  }
}

TEST(WriteMesh, ChecksNamesWithoutWriting) {
  const test::TestFolder folder;
  for (const char* name : {"missing/a.ply", "a.xyz", "a", "a.gltf"})
    EXPECT_THROW(check_mesh_output(folder.path() / name), Error) << name;
  for (const char* name : {"a.ply", "a.obj", "a.off", "A.STL", "a.GLB"})
    EXPECT_NO_THROW(check_mesh_output(folder.path() / name)) << name;
  EXPECT_EQ(test::files_in(folder.path()), 0u);
}

TEST(WriteMesh, FailureLeavesWhatWasThere) {
  const test::TestFolder folder;
  const TriangleMesh mesh = test::tetrahedron();
  EXPECT_THROW(write_mesh(folder.path() / "missing" / "a.ply", mesh), Error);
  EXPECT_THROW(write_mesh(folder.path() / "a.xyz", mesh), Error);
  EXPECT_THROW(write_mesh(folder.path() / "a", mesh), Error);
  fs::create_directory(folder.path() / "folder.ply");
  EXPECT_THROW(write_mesh(folder.path() / "folder.ply", mesh), Error);
  EXPECT_TRUE(fs::is_directory(folder.path() / "folder.ply"));
  EXPECT_EQ(test::files_in(folder.path()), 1u);  // and no temporary is left
}

}  // namespace
}  // namespace occlod
