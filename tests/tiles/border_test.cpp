#include <gtest/gtest.h>

#include <algorithm>
#include <glm/glm.hpp>
#include <map>
#include <tuple>
#include <utility>

#include "hlod/tiles/tile_mesh.h"
#include "tile_support.h"

namespace occlod::tiles {
namespace {

using occlod::test::grid;
using test::nested_hlod;

TEST(BorderEdges, OfPositionsAndAsWound) {
  // Two triangles of a square, the diagonal between vertices of their own: four edges, none along the diagonal.
  const std::vector<glm::vec3> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}};
  const std::vector<std::uint32_t> first = first_at_position(positions);
  EXPECT_EQ(first, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 5}));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const BorderEdge& edge : border_edges(triangles, first)) edges.emplace_back(edge.from, edge.to);
  EXPECT_EQ(edges, (std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {1, 2}, {4, 5}, {5, 3}}));
}

TEST(BorderEdges, AnEdgeOfThreeTrianglesIsNoBorder) {
  const TriangleMesh book = occlod::test::book(3);
  EXPECT_EQ(border_edges(book.triangles, first_at_position(book.positions)).size(), 6U);  // two of each page
}

// A square is cut into nodes: its rim is the input's border, the cuts are not; all normals are +z.
TEST(BorderVertices, TellTheInputsBorderFromCuts) {
  const hlod::Hlod hlod = nested_hlod(grid(32, 32));
  const BorderVertices borders(hlod, [] {});
  std::size_t on_rim = 0, on_cuts = 0;
  for (const glm::vec3& p : grid(32, 32).positions) {
    const BorderVertex* vertex = borders.at(p);
    const bool is_rim = p.x == 0.0F || p.y == 0.0F || p.x == 1.0F || p.y == 1.0F;
    if (is_rim) {
      ASSERT_NE(vertex, nullptr);
    }
    if (vertex == nullptr) continue;
    EXPECT_EQ(vertex->is_at_input_border, is_rim);
    ASSERT_EQ(vertex->normal_count, 1U);
    EXPECT_EQ(borders.normals(*vertex)[0], glm::vec3(0, 0, 1));
    ++(is_rim ? on_rim : on_cuts);
  }
  EXPECT_EQ(on_rim, 128U);
  EXPECT_GT(on_cuts, 200U);
  EXPECT_EQ(borders.at({0.5F, 0.5F, 1.0F}), nullptr);
}

// On a smooth closed surface there is one normal at each place, in whatever tile of level 0.
TEST(TileMesh, NormalsAgreeAcrossBorders) {
  const hlod::Hlod hlod = nested_hlod(occlod::test::octahedron_sphere(4));
  const BorderVertices borders(hlod, [] {});
  std::map<std::tuple<float, float, float>, glm::vec3> normals;
  std::size_t shared = 0;
  const hlod::Level& finest = hlod.data().levels[0];
  for (hlod::NodeId n = finest.first_node; n < finest.first_node + finest.node_count; ++n) {
    const TileMesh tile = tile_mesh(hlod, n, borders);
    for (std::size_t v = 0; v < tile.mesh.positions.size(); ++v) {
      const glm::vec3& p = tile.mesh.positions[v];
      EXPECT_GT(glm::dot(tile.mesh.normals[v], p), 0.99F);  // the sphere's, nearly
      const auto [at, is_new] = normals.try_emplace({p.x, p.y, p.z}, tile.mesh.normals[v]);
      EXPECT_EQ(at->second, tile.mesh.normals[v]);
      shared += is_new ? 0U : 1U;
    }
  }
  EXPECT_GT(shared, 100U);
}

// A square that is folded up at a right angle, x = 0.5: the floor faces +z and the wall -x, also where the fold is the
// border of a node, and where a node has one side of it only.
TEST(TileMesh, NormalsAreHardAcrossRightAngles) {
  TriangleMesh mesh = grid(32, 32);
  for (glm::vec3& p : mesh.positions)
    if (p.x > 0.5F) p = {0.5F, p.y, p.x - 0.5F};
  const hlod::Hlod hlod = nested_hlod(mesh);
  const BorderVertices borders(hlod, [] {});
  std::size_t on_borders = 0;
  const hlod::Level& finest = hlod.data().levels[0];
  for (hlod::NodeId n = finest.first_node; n < finest.first_node + finest.node_count; ++n) {
    const TriangleMesh tile = tile_mesh(hlod, n, borders).mesh;
    for (const Triangle& t : tile.triangles)
      for (int k = 0; k < 3; ++k) {
        const bool is_floor = tile.positions[t.x].z + tile.positions[t.y].z + tile.positions[t.z].z == 0.0F;
        EXPECT_EQ(tile.normals[t[k]], is_floor ? glm::vec3(0, 0, 1) : glm::vec3(-1, 0, 0));
        const BorderVertex* const border = borders.at(tile.positions[t[k]]);
        const bool is_on_fold = tile.positions[t[k]].x == 0.5F && tile.positions[t[k]].z == 0.0F;
        if (border == nullptr || !is_on_fold) continue;
        EXPECT_EQ(border->normal_count, 2U);
        ++on_borders;
      }
  }
  EXPECT_GT(on_borders, 20U);
}

// A node of a square in its middle: with skirts every edge of its rim is used twice, once in each direction, and what
// hangs there ends `depth` below, on the side that its normals do not point to.
TEST(Skirts, HangFromCuts) {
  const hlod::Hlod hlod = nested_hlod(grid(32, 32));
  const BorderVertices borders(hlod, [] {});
  std::size_t with_skirts = 0, with_rim = 0;
  const hlod::Level& finest = hlod.data().levels[0];
  for (hlod::NodeId n = finest.first_node; n < finest.first_node + finest.node_count; ++n) {
    TileMesh tile = tile_mesh(hlod, n, borders);
    const std::size_t vertices = tile.mesh.positions.size(), triangles = tile.mesh.triangles.size();
    const std::vector<BorderEdge> before = border_edges(tile.mesh.triangles, first_at_position(tile.mesh.positions));
    add_skirts(tile, 0.25, borders);
    const auto is_rim = [&](std::uint32_t v) {
      const glm::vec3& p = tile.mesh.positions[v];
      return p.x == 0.0F || p.y == 0.0F || p.x == 1.0F || p.y == 1.0F;
    };
    std::size_t cuts = 0;
    for (const BorderEdge& edge : before) cuts += is_rim(edge.from) && is_rim(edge.to) ? 0U : 1U;
    EXPECT_EQ(tile.skirt_triangles, 2 * cuts);
    EXPECT_EQ(tile.mesh.triangles.size(), triangles + 2 * cuts);
    with_rim += cuts < before.size() ? 1U : 0U;
    with_skirts += cuts > 0 ? 1U : 0U;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
    for (const Triangle& t : tile.mesh.triangles)
      for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
    for (const BorderEdge& edge : before) {
      const int expected = is_rim(edge.from) && is_rim(edge.to) ? 0 : 1;
      EXPECT_EQ((uses[{edge.to, edge.from}]), expected);
    }
    for (std::size_t v = 0; v < tile.mesh.positions.size(); ++v)
      EXPECT_EQ(tile.mesh.positions[v].z, v < vertices ? 0.0F : -0.25F);
    ASSERT_EQ(tile.mesh.normals.size(), tile.mesh.positions.size());
  }
  EXPECT_GT(with_skirts, 4U);
  EXPECT_GT(with_rim, 4U);
}

}  // namespace
}  // namespace occlod::tiles
