// Building from pieces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "hlod_bytes.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"
#include "support/meshes.h"
#include "support/wedge_meshes.h"

namespace occlod::hlod {
namespace {

// The mesh in pieces of so many triangles, each with a vertex for each wedge that it uses.
TriangleSource in_pieces(const TriangleMesh& mesh, std::size_t size) {
  return [&mesh, size](TriangleSink& sink) {
    for (std::size_t begin = 0; begin < mesh.triangle_count(); begin += size) {
      TriangleMesh piece;
      std::vector<WedgeId> wedges;
      for (std::size_t t = begin; t < std::min(mesh.triangle_count(), begin + size); ++t) {
        Triangle triangle = mesh.wedge_triangles()[t];
        for (int k = 0; k < 3; ++k) {
          const auto found = std::find(wedges.begin(), wedges.end(), triangle[k]);
          if (found == wedges.end()) wedges.push_back(triangle[k]);
          triangle[k] = static_cast<VertexId>(std::find(wedges.begin(), wedges.end(), triangle[k]) - wedges.begin());
        }
        piece.triangles.push_back(triangle);
        if (!mesh.triangle_materials.empty()) piece.triangle_materials.push_back(mesh.triangle_materials[t]);
      }
      for (const WedgeId w : wedges) {
        piece.positions.push_back(mesh.positions[w]);
        if (!mesh.normals.empty()) piece.normals.push_back(mesh.normals[w]);
        if (!mesh.colors.empty()) piece.colors.push_back(mesh.colors[w]);
        if (!mesh.texture_coordinates.empty()) piece.texture_coordinates.push_back(mesh.texture_coordinates[w]);
      }
      piece.materials = mesh.materials;
      piece.textures = mesh.textures;
      piece.texture_origin = mesh.texture_origin;
      sink.add(piece);
    }
  };
}

Hlod build(const TriangleSource& source, MeshReport& report) {
  HlodBuildOptions options;
  options.node_triangles = 64;
  return build_hlod(source, options, report);
}

Hlod build(const TriangleSource& source) {
  MeshReport report;
  return build(source, report);
}

std::string refusal(const TriangleSource& source) {
  try {
    (void)build(source);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(StreamedHlod, ComesBackWhateverThePieces) {
  TriangleMesh striped = occlod::test::grid_of_charts(
      32, [](int i, int) { return i / 16; }, [](int i, int) { return i / 16; });
  striped.materials.resize(2);
  const std::vector<TriangleMesh> meshes = {occlod::test::noisy_sphere(4, 1), occlod::test::book(40),
                                            std::move(striped), occlod::test::cylinder_with_seam(48, 24),
                                            occlod::test::cube_of_charts(8)};
  for (const TriangleMesh& mesh : meshes) {
    const Hlod whole = build(in_pieces(mesh, mesh.triangle_count()));
    EXPECT_EQ(validate(whole), std::vector<std::string>{});
    EXPECT_TRUE(restores(whole, mesh));
    EXPECT_EQ(whole.data().has_seams, !mesh.extra_wedges.empty());
    for (const std::size_t size : {1U, 7U, 300U})
      EXPECT_EQ(test::bytes_of(build(in_pieces(mesh, size))), test::bytes_of(whole)) << "pieces of " << size;
  }
}

TEST(StreamedHlod, SoupsWithSeamsComeBack) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const TriangleMesh mesh = occlod::test::random_soup_with_wedges(seed);
    const Hlod hlod = build(in_pieces(mesh, 5));
    ASSERT_EQ(validate(hlod), std::vector<std::string>{}) << "seed " << seed;
    ASSERT_TRUE(restores(hlod, mesh)) << "seed " << seed;
  }
}

TEST(StreamedHlod, CountsWhatItDropsAndWelds) {
  const TriangleMesh mesh = occlod::test::single_triangle();
  const TriangleSource source = [&](TriangleSink& sink) {
    sink.add(mesh);
    TriangleMesh flat = mesh;
    flat.triangles = {{0, 1, 0}};
    sink.add(flat);
    sink.add(TriangleMesh{});
    TriangleMesh more = mesh;
    more.positions.emplace_back(9.0F);
    more.positions[0].z += 1.0F;
    sink.add(more);
  };
  MeshReport report;
  const Hlod hlod = build(source, report);
  EXPECT_EQ(hlod.data().input_triangle_count, 2U);
  EXPECT_EQ(report.triangles_read, 3U);
  EXPECT_EQ(report.repeated_index_triangles, 1U);
  EXPECT_EQ(report.unreferenced_vertices, 1U);
  EXPECT_EQ(report.vertices_welded, 2U);
}

TEST(StreamedHlod, PiecesWithoutSomeAttributesAreGivenNone) {
  TriangleMesh plain = occlod::test::noisy_sphere(2, 1), colored = plain;
  for (glm::vec3& p : colored.positions) p.x += 5.0F;
  colored.colors.assign(colored.positions.size(), glm::u8vec4(200));
  colored.texture_coordinates.assign(colored.positions.size(), glm::vec2(0.5F));
  for (const bool plain_first : {true, false}) {
    const Hlod hlod = build([&](TriangleSink& sink) {
      sink.add(plain_first ? plain : colored);
      sink.add(plain_first ? colored : plain);
    });
    EXPECT_FALSE(hlod.data().has_colors);
    ASSERT_TRUE(hlod.data().has_texture_coordinates);
    for (NodeId n = 0; n < hlod.node_count(); ++n)
      for (std::size_t v = 0; v < hlod.mesh(n).positions.size(); ++v)
        EXPECT_EQ(hlod.mesh(n).texture_coordinates[v].x, hlod.mesh(n).positions[v].x > 2.5F ? 0.5F : 0.0F);
  }
}

TEST(StreamedHlod, WhatCannotBeBuiltIsRefused) {
  EXPECT_NE(refusal([](TriangleSink&) {}).find("no triangle with three different corners"), std::string::npos);
  TriangleMesh mesh = occlod::test::single_triangle();
  mesh.positions[1].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(refusal(in_pieces(mesh, 1)).find("piece 0: vertex 1"), std::string::npos) << refusal(in_pieces(mesh, 1));
  mesh = occlod::test::single_triangle();
  mesh.triangles[0].z = 3;
  EXPECT_NE(refusal([&](TriangleSink& sink) { sink.add(mesh); }).find("uses vertex 3"), std::string::npos);
}

TEST(StreamedHlod, ALimitOfMemoryChangesNothing) {
  const TriangleSource planet = [](TriangleSink& sink) {
    stream_generated("rough-planet", {{"level", 9}}, [&](const TriangleMesh& piece, std::size_t) { sink.add(piece); });
  };
  MeshReport report;
  const Hlod free = build_hlod(planet, {}, report);
  const std::filesystem::path folder = ::testing::TempDir();
  const MemoryLimit limit(std::size_t{64} << 20U, folder);
  const Hlod limited = build_hlod(planet, {}, report);
  EXPECT_GT(limit.max_scratch_bytes(), std::size_t{100} << 20U);
  EXPECT_EQ(free.data().input_triangle_count, 8U << 18U);
  EXPECT_TRUE(std::ranges::equal(free.data().meshes, limited.data().meshes));
  EXPECT_EQ(free.node_count(), limited.node_count());
  EXPECT_TRUE(restores(limited, planet));
}

TEST(StreamedHlod, APositionThatDiffersIsFound) {
  TriangleMesh mesh = occlod::test::noisy_sphere(3, 1);
  const Hlod hlod = build(in_pieces(mesh, 50));
  EXPECT_TRUE(restores(hlod, in_pieces(mesh, 33)));
  mesh.positions[5].x = std::nextafter(mesh.positions[5].x, 9.0F);
  EXPECT_FALSE(restores(hlod, in_pieces(mesh, 33)));
  mesh = occlod::test::noisy_sphere(3, 1);
  std::swap(mesh.triangles[3].x, mesh.triangles[3].y);
  EXPECT_FALSE(restores(hlod, in_pieces(mesh, 33))) << "turned over";
  mesh.triangles.pop_back();
  EXPECT_FALSE(restores(hlod, in_pieces(mesh, 33)));
}

TEST(StreamRoughPlanet, PiecesAreTheWholeMesh) {
  for (const int level : {0, 3, 8}) {
    const TriangleMesh whole = generate("rough-planet", {{"level", level}});
    std::size_t triangles = 0;
    stream_generated("rough-planet", {{"level", level}}, [&](const TriangleMesh& piece, std::size_t) {
      for (const Triangle& t : piece.triangles) {
        for (int k = 0; k < 3; ++k)
          ASSERT_EQ(piece.positions[t[k]], whole.positions[whole.triangles[triangles][k]]) << triangles;
        ++triangles;
      }
    });
    EXPECT_EQ(triangles, whole.triangle_count());
  }
}

}  // namespace
}  // namespace occlod::hlod
