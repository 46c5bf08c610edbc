#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <limits>

#include "hlod/tiles/tile_tree.h"
#include "occlod/base.h"
#include "occlod/hlod.h"
#include "occlod/tiles.h"
#include "support/error_of.h"
#include "support/hand_made_hlod.h"
#include "tile_support.h"

namespace occlod::tiles {
namespace {

using occlod::test::error_of;
using test::Folder;
using test::nested_hlod;
using test::read_content;

// The finest tiles together are the input, bit for bit.
TEST(WriteTileset, FinestTilesAreTheInput) {
  TriangleMesh input = occlod::test::noisy_sphere(5, 11);
  for (glm::vec3& p : input.positions) p = 40.0F * p + glm::vec3(1000.0F, -3.0F, 0.5F);
  const hlod::Hlod hlod = nested_hlod(input);
  const Folder folder;
  const TilesetCounts counts = write_tileset(folder / "tiles", hlod);
  EXPECT_EQ(counts.tiles, hlod.node_count());
  TriangleMesh all;
  const hlod::Level& finest = hlod.data().levels[0];
  for (hlod::NodeId n = finest.first_node; n < finest.first_node + finest.node_count; ++n) {
    const TriangleMesh tile = read_content(folder / "tiles/" / content_name(n));
    for (const Triangle& t : tile.triangles) all.triangles.push_back(t + static_cast<VertexId>(all.positions.size()));
    all.positions.insert(all.positions.end(), tile.positions.begin(), tile.positions.end());
  }
  EXPECT_TRUE(hlod::restores(hlod, clean(all, {}, "tiles").mesh));
}

// The skirts of a coarse tile reach beyond its box, as far as the boxes in the tileset say (the strict checker compares
// them with the vertices).
TEST(WriteTileset, ShowsProgressAndCounts) {
  const hlod::Hlod hlod = nested_hlod(occlod::test::noisy_sphere(4, 1));
  const Folder folder;
  TilesetOptions options;
  options.skirts = true;
  double last = -1.0;
  options.progress = [&](double done) {
    EXPECT_GE(done, last);
    EXPECT_LE(done, 1.0);
    last = done;
  };
  const TilesetCounts counts = write_tileset(folder / "tiles", hlod, options);
  EXPECT_GT(last, 0.9);
  std::uint64_t stored = 0;
  for (const hlod::Node& node : hlod.data().nodes) stored += node.triangles;
  EXPECT_EQ(counts.triangles, stored);
  EXPECT_GT(counts.skirt_triangles, 0U);
  EXPECT_GT(counts.bytes, counts.content_bytes);
}

TEST(WriteTileset, WhatProgressThrowsLeavesNothing) {
  const hlod::Hlod hlod = nested_hlod(occlod::test::noisy_sphere(4, 1));
  const Folder folder;
  TilesetOptions options;
  options.progress = [](double done) {
    if (done > 0.5) throw std::runtime_error("enough");
  };
  EXPECT_THROW(write_tileset(folder / "tiles", hlod, options), std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
}

TEST(WriteTileset, RefusesBadOptions) {
  const hlod::Hlod hlod = nested_hlod(occlod::test::noisy_sphere(3, 1));
  const Folder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, std::function<void(TilesetOptions&)>>> bad = {
      {"quantise_bits", [](TilesetOptions& o) { o.quantise_bits = 7; }},
      {"quantise_bits", [](TilesetOptions& o) { o.quantise_bits = 17; }},
      {"quantise_bits", [](TilesetOptions& o) { o.quantise_bits = -1; }},
      {"longitude_deg",
       [](TilesetOptions& o) {
         o.origin = {180.5, 0.0, 0.0};
       }},
      {"latitude_deg",
       [](TilesetOptions& o) {
         o.origin = {0.0, -91.0, 0.0};
       }},
      {"height_m",
       [&](TilesetOptions& o) {
         o.origin = {0.0, 0.0, nan};
       }},
  };
  for (const auto& [name, change] : bad) {
    TilesetOptions options;
    change(options);
    EXPECT_NE(error_of([&] { write_tileset(folder / "tiles", hlod, options); }).find(name), std::string::npos) << name;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
}

TEST(WriteTileset, RefusesWhatIsNoTree) {
  const Folder folder;
  const std::string several = "has nodes with several parents";
  EXPECT_NE(error_of([&] { write_tileset(folder / "tiles", occlod::test::shared_child()); }).find(several),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              write_tileset(folder / "tiles",
                            hlod::build_hlod(occlod::test::noisy_sphere(4, 1), {.node_triangles = 64}));
            }).find(several),
            std::string::npos);
  EXPECT_NE(error_of([&] { write_tileset(folder / "tiles", hlod::Hlod()); }).find("has no nodes"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
}

// Sizes at the ends of what meshes may have: numbers in the JSON stay finite, contents can be read.
TEST(WriteTileset, AnySize) {
  for (const float scale : {1e-40F, 1e-20F, 1e20F, 1e37F}) {
    TriangleMesh mesh = occlod::test::noisy_sphere(3, 4);
    for (glm::vec3& p : mesh.positions) p *= scale;
    const hlod::Hlod hlod = nested_hlod(mesh, 64, hlod::Borders::locked);
    for (const int bits : {0, 16}) {
      const Folder folder;
      TilesetOptions options;
      options.quantise_bits = bits;
      options.skirts = true;
      const TilesetCounts counts = write_tileset(folder / "tiles", hlod, options);
      EXPECT_EQ(counts.tiles, hlod.node_count());
      std::ifstream stream(folder / "tiles/tileset.json");
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      EXPECT_EQ(text.find("null"), std::string::npos) << scale;  // what JSON makes of NaN
      for (hlod::NodeId n = 0; n < hlod.node_count(); ++n)
        EXPECT_GT(read_content(folder / "tiles/" / content_name(n)).triangles.size(), 0U);
    }
  }
}

}  // namespace
}  // namespace occlod::tiles
