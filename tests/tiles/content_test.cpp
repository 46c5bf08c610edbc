#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/glm.hpp>
#include <tuple>

#include "hlod/tiles/encode_tile.h"
#include "mesh/wedges.h"
#include "tile_support.h"

namespace occlod::tiles {
namespace {

using test::decoded;

// Triangles as sets of positions in cyclic order from the least, so that vertices may be numbered anew.
using Corners = std::array<std::tuple<float, float, float>, 3>;

template <typename Move>
std::vector<Corners> corners_of(const TriangleMesh& mesh, const Move& move) {
  std::vector<Corners> all;
  for (const Triangle& t : mesh.triangles) {
    Corners corners;
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 p = move(mesh.positions[t[k]]);
      corners[static_cast<std::size_t>(k)] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.push_back(corners);
  }
  std::sort(all.begin(), all.end());
  return all;
}

glm::vec3 as_it_is(const glm::vec3& p) { return p; }

// A bumpy sphere away from the origin, with normals, and colours that differ.
TileMesh colorful_tile(const glm::vec3& move = {5.0F, -300.0F, 0.25F}) {
  TriangleMesh mesh = occlod::test::noisy_sphere(3, 7);
  for (const glm::vec3& p : mesh.positions) mesh.normals.push_back(glm::normalize(p));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) mesh.colors.emplace_back(v % 256, 255 - v % 256, 40, 255);
  for (glm::vec3& p : mesh.positions) p += move;
  return {mesh};
}

const FileErrors errors("tile");

TEST(Content, FloatsAreExact) {
  const TileMesh tile = colorful_tile();
  const TileContent content = encode_tile(tile, {}, {}, errors);
  const TriangleMesh read = decoded(content);
  EXPECT_EQ(corners_of(read, as_it_is), corners_of(tile.mesh, as_it_is));
  ASSERT_EQ(read.positions.size(), tile.mesh.positions.size());
  EXPECT_EQ(read.positions, tile.mesh.positions);  // the order too
  for (std::size_t v = 0; v < read.positions.size(); ++v) {
    EXPECT_LT(glm::distance(read.normals[v], tile.mesh.normals[v]), 1e-6F);
    EXPECT_EQ(read.colors[v], tile.mesh.colors[v]);  // through linear light and back
  }
  TileBox box;
  for (const glm::vec3& p : tile.mesh.positions) box.take(glm::dvec3(p));
  EXPECT_EQ(content.box.min, box.min);
  EXPECT_EQ(content.box.max, box.max);
}

// Of eight features the tile has the fourth and the last, the upper and the lower half of its triangles; what reads it
// has their names, and knows the halves apart, compressed or not.
TEST(Content, FeaturesHaveNames) {
  const std::vector<std::string> names = {"0", "1", "2", "Dach, gro\xc3\x9f", "4", "5", "6", ""};
  TriangleMesh mesh = colorful_tile().mesh;
  const auto is_upper = [&](const TriangleMesh& of, const Triangle& t) {
    return of.positions[t.x].z + of.positions[t.y].z + of.positions[t.z].z > 0.75F;  // around z = 0.25
  };
  for (const Triangle& t : mesh.triangles) mesh.triangle_features.push_back(is_upper(mesh, t) ? 0 : 1);
  mesh.feature_names.resize(2);
  mesh = part_features(std::move(mesh));
  mesh.triangles = std::move(mesh.corners);
  mesh.corners.clear();
  mesh.extra_wedges.clear();
  const TileMesh tile{.mesh = mesh, .features = {3, 7}};
  TileLook look;
  look.feature_names = names;
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    if (compression == Compression::meshopt && !has_meshopt()) continue;
    const TriangleMesh read = decoded(encode_tile(tile, look, {compression, 0}, errors));
    ASSERT_EQ(read.triangle_features.size(), mesh.triangles.size());
    for (std::size_t t = 0; t < read.triangle_count(); ++t)
      EXPECT_EQ(read.feature_names[read.triangle_features[t]], is_upper(read, read.triangles[t]) ? names[3] : names[7]);
  }
}

TEST(Content, QuantisedLiesOnTheLattice) {
  const TileMesh tile = colorful_tile();
  for (const int bits : {8, 11, 16}) {
    const TileLattice lattice(tile.mesh.positions, bits);
    const TileContent content = encode_tile(tile, {}, {Compression::none, bits}, errors);
    const auto rounded = [&](const glm::vec3& p) { return glm::vec3(lattice.position(lattice.at(p))); };
    TriangleMesh expected = tile.mesh;
    for (glm::vec3& p : expected.positions) p = rounded(p);
    std::erase_if(expected.triangles, [&](const Triangle& t) {  // the reader drops what has become degenerate
      const glm::vec3 &a = expected.positions[t.x], &b = expected.positions[t.y], &c = expected.positions[t.z];
      return a == b || b == c || c == a;
    });
    EXPECT_EQ(corners_of(decoded(content), as_it_is), corners_of(expected, as_it_is));
    for (const glm::vec3& p : expected.positions)
      for (int k = 0; k < 3; ++k) {
        EXPECT_LE(content.box.min[k], p[k]);
        EXPECT_GE(content.box.max[k], p[k]);
      }
  }
}

TEST(Content, CompressedHoldsTheSame) {
  if (!has_meshopt()) GTEST_SKIP() << "built without meshoptimizer";
  const TileMesh tile = colorful_tile();
  for (const int bits : {0, 12, 16}) {
    const TileContent plain = encode_tile(tile, {}, {Compression::none, bits}, errors);
    const TileContent small = encode_tile(tile, {}, {Compression::meshopt, bits}, errors);
    EXPECT_LT(small.bytes.size(), plain.bytes.size());
    const TriangleMesh a = decoded(plain), b = decoded(small);
    EXPECT_EQ(corners_of(a, as_it_is), corners_of(b, as_it_is));
    EXPECT_EQ(plain.box.min, small.box.min);
    // Attributes stay with their vertices.
    const auto colors_by_position = [](const TriangleMesh& mesh) {
      std::vector<std::tuple<float, float, float, std::uint8_t, float>> all;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const glm::vec3& p = mesh.positions[v];
        all.emplace_back(p.x, p.y, p.z, mesh.colors[v].r, mesh.normals[v].x);
      }
      std::sort(all.begin(), all.end());
      return all;
    };
    EXPECT_EQ(colors_by_position(a), colors_by_position(b));
  }
}

// From 65,535 vertices on indices have four bytes: 65535 itself is no index.
TEST(Content, IndicesAreAsWideAsNeeded) {
  for (const int rows : {255, 256}) {
    TileMesh tile{occlod::test::grid(255, rows - 1)};  // 256 * rows vertices
    tile.mesh.normals.assign(tile.mesh.positions.size(), glm::vec3(0, 0, 1));
    const std::string bytes = encode_tile(tile, {}, {}, errors).bytes;
    const bool is_long = tile.mesh.positions.size() >= 65535;
    EXPECT_EQ(is_long, rows == 256);
    EXPECT_EQ(bytes.find("\"componentType\":5125") != std::string::npos, is_long);
    EXPECT_EQ(decoded({bytes, {}}).triangles.size(), tile.mesh.triangles.size());
  }
}

}  // namespace
}  // namespace occlod::tiles
