// HLODs of meshes whose positions are rounded to a lattice.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "hlod_bytes.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"
#include "support/meshes.h"
#include "support/wedge_meshes.h"

namespace occlod::hlod {
namespace {

HlodBuildOptions quantised(int bits) {
  HlodBuildOptions options;
  options.node_triangles = 64;
  options.quantise_bits = bits;
  return options;
}

std::vector<TriangleMesh> meshes() {
  TriangleMesh striped = occlod::test::grid_of_charts(
      32, [](int i, int) { return i / 16; }, [](int i, int) { return i / 16; });
  striped.materials.resize(2);
  return {occlod::test::noisy_sphere(5, 1), occlod::test::book(40), std::move(striped),
          occlod::test::cylinder_with_seam(48, 24)};
}

TEST(QuantisedHlod, HasTheRoundedMesh) {
  for (const TriangleMesh& mesh : meshes()) {
    const Hlod hlod = build_hlod(mesh, quantised(10));
    const float step = hlod.data().lattice_step;
    EXPECT_EQ(step, lattice_step(bounding_box(mesh.positions), 10));
    EXPECT_EQ(validate(hlod), std::vector<std::string>{});
    for (NodeId n = 0; n < hlod.node_count(); ++n)
      for (const glm::vec3& p : hlod.mesh(n).positions)
        for (int k = 0; k < 3; ++k) ASSERT_EQ(std::fmod(p[k], step), 0.0F);
    EXPECT_TRUE(restores(hlod, mesh));
    TriangleMesh moved = mesh;
    for (glm::vec3& p : moved.positions) p.x += step;
    EXPECT_FALSE(restores(hlod, moved));
  }
}

// Of what falls together nothing is left over, whether the mesh comes as a whole or in pieces.
TEST(QuantisedHlod, IsTheSameFromPieces) {
  for (const TriangleMesh& mesh : meshes()) {
    const Hlod whole = build_hlod(mesh, quantised(8));
    const auto in_two = [&](TriangleSink& sink) {
      for (int half = 0; half < 2; ++half) {
        TriangleMesh piece = mesh;
        const std::size_t middle = mesh.triangle_count() / 2, begin = half == 0 ? 0 : middle;
        const std::size_t count = half == 0 ? middle : mesh.triangle_count() - middle;
        const auto keep = [&](auto& values) {
          if (!values.empty())
            values = {values.begin() + static_cast<std::ptrdiff_t>(begin),
                      values.begin() + static_cast<std::ptrdiff_t>(begin + count)};
        };
        keep(piece.triangles);
        keep(piece.corners);
        keep(piece.triangle_materials);
        sink.add(piece);
      }
    };
    MeshReport report;
    const Hlod pieces = build_hlod(in_two, quantised(8), report);
    EXPECT_TRUE(test::bytes_of(pieces) == test::bytes_of(whole));
    EXPECT_EQ(pieces.data().lattice_step, whole.data().lattice_step);
    EXPECT_TRUE(restores(pieces, in_two));
    EXPECT_EQ(report.triangles_read - report.repeated_index_triangles, whole.data().input_triangle_count);
  }
}

TEST(QuantisedHlod, DropsTrianglesThatFallTogether) {
  TriangleMesh mesh = occlod::test::noisy_sphere(5, 1);
  for (glm::vec3& p : mesh.positions)
    if (p.z < 0.0F) p *= 0.02F;
  const Hlod hlod = build_hlod(mesh, quantised(8));
  EXPECT_LT(hlod.data().input_triangle_count, mesh.triangle_count());
  EXPECT_TRUE(restores(hlod, mesh));
  EXPECT_EQ(build_hlod(mesh, quantised(20)).data().input_triangle_count, mesh.triangle_count());
}

TEST(QuantisedHlod, IsTheSameForAnyThreads) {
  HlodBuildOptions options = quantised(12);
  const TriangleMesh mesh = occlod::test::noisy_sphere(5, 2);
  options.threads = 1;
  const std::string one = test::bytes_of(build_hlod(mesh, options));
  options.threads = 3;
  EXPECT_TRUE(test::bytes_of(build_hlod(mesh, options)) == one);
}

TEST(QuantisedHlod, BadOptionsAndMeshesOfNothingAreErrors) {
  TriangleMesh needle;
  needle.positions = {{0, 0, 0}, {1, 0, 0}, {0.5F, 1e-4F, 0}, {0.5F, -1e-4F, 0}};
  needle.triangles = {{0, 2, 3}};
  EXPECT_NO_THROW((void)build_hlod(needle, quantised(0)));
  EXPECT_THROW((void)build_hlod(needle, quantised(8)), Error);
  MeshReport report;
  const auto source = [&](TriangleSink& sink) { sink.add(needle); };
  EXPECT_THROW((void)build_hlod(source, quantised(8), report), Error);
  for (const int bits : {-1, 1, 7, 24}) EXPECT_THROW((void)build_hlod(needle, quantised(bits)), Error) << bits;
}

}  // namespace
}  // namespace occlod::hlod
