#include "occlod/openmesh.h"

#include <gtest/gtest.h>

#include "support/meshes.h"

namespace occlod {
namespace {

using FloatMesh = OpenMesh::TriMesh_ArrayKernelT<>;

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  using Color = OpenMesh::Vec4f;
};
using DoubleMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

template <class Mesh>
void expect_round_trip(const TriangleMesh& mesh) {
  Mesh half_edges;
  EXPECT_EQ(to_openmesh(mesh, half_edges), 0u);
  EXPECT_EQ(half_edges.n_faces(), mesh.triangle_count());
  const TriangleMesh back = from_openmesh(half_edges);
  EXPECT_EQ(back.positions, mesh.positions);
  ASSERT_EQ(back.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    // OpenMesh may begin a face at another corner, but keeps its order round.
    const Triangle& a = mesh.triangles[t];
    const Triangle& b = back.triangles[t];
    EXPECT_TRUE(b == a || b == Triangle(a.y, a.z, a.x) || b == Triangle(a.z, a.x, a.y));
  }
}

TEST(OpenMeshInterop, ManifoldsGoThereAndBack) {
  expect_round_trip<FloatMesh>(test::torus(5, 4));
  expect_round_trip<FloatMesh>(test::grid(3, 2));
  expect_round_trip<DoubleMesh>(test::two_components());
}

TEST(OpenMeshInterop, CarriesNormalsAndColoursWhereBothSidesHaveThem) {
  TriangleMesh mesh = test::tetrahedron();
  mesh.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}};
  mesh.colors = {{255, 0, 0, 255}, {0, 255, 0, 0}, {0, 0, 0, 255}, {255, 255, 255, 255}};
  DoubleMesh half_edges;
  EXPECT_EQ(to_openmesh(mesh, half_edges), 0u);
  EXPECT_TRUE(from_openmesh(half_edges).normals.empty());
  half_edges.request_vertex_normals();
  half_edges.request_vertex_colors();
  EXPECT_EQ(to_openmesh(mesh, half_edges), 0u);
  EXPECT_EQ(from_openmesh(half_edges).normals, mesh.normals);
  EXPECT_EQ(from_openmesh(half_edges).colors, mesh.colors);
}

// Three pages on one edge: a half-edge mesh holds two at most, and only if they run along it in opposite directions.
TEST(OpenMeshInterop, CountsWhatHalfEdgesCannotHold) {
  FloatMesh half_edges;
  EXPECT_EQ(to_openmesh(test::book(3), half_edges), 2u);
  EXPECT_EQ(to_openmesh(test::moebius(5), half_edges), 1u);
  TriangleMesh repeated = test::single_triangle();
  repeated.triangles.emplace_back(0u, 0u, 1u);
  EXPECT_EQ(to_openmesh(repeated, half_edges), 1u);
  EXPECT_EQ(half_edges.n_vertices(), 3u);  // what was there before is gone
}

TEST(OpenMeshInterop, SkipsWhatIsDeleted) {
  FloatMesh half_edges;
  half_edges.request_vertex_status();
  half_edges.request_edge_status();
  half_edges.request_face_status();
  ASSERT_EQ(to_openmesh(test::tetrahedron(), half_edges), 0u);
  half_edges.delete_vertex(half_edges.vertex_handle(0), false);  // with its three triangles
  const TriangleMesh back = from_openmesh(half_edges);
  EXPECT_EQ(back.positions, (std::vector<glm::vec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  ASSERT_EQ(back.triangle_count(), 1u);
  EXPECT_EQ(back.triangles[0].x + back.triangles[0].y + back.triangles[0].z, 3u);  // 0, 1, 2 in some rotation
}

}  // namespace
}  // namespace occlod
