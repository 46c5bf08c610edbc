// Images of tiles: charts, what is divided among tiles, and what a tile's image shows.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <set>
#include <utility>
#include <vector>

#include "hlod/store/hlod_data.h"
#include "hlod/texture/charts.h"
#include "hlod/texture/pack_shapes.h"
#include "hlod/texture/source_textures.h"
#include "hlod/texture/tile_texture.h"
#include "hlod/tiles/tile_mesh.h"
#include "hlod/tiles/tile_tree.h"
#include "mesh/image_codec.h"
#include "occlod/base.h"
#include "occlod/hlod.h"
#include "occlod/node_store.h"
#include "occlod/tiles.h"
#include "tile_support.h"

namespace occlod::tiles {
namespace {

using test::Folder;
using test::nested_hlod;

using Color = std::function<glm::u8vec4(int x, int y)>;

Texture texture_of(int width, int height, const Color& color) {
  std::vector<glm::u8vec4> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) pixels.push_back(color(x, y));
  Texture texture;
  texture.mime_type = "image/png";
  texture.bytes = encode_png(pixels, width);
  return texture;
}

// A different colour for each texel of an image of up to 256 x 256.
glm::u8vec4 own_color(int x, int y) {
  return {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), static_cast<std::uint8_t>((7 * x) ^ (13 * y)),
          255};
}

// Adds a flat sheet of n x n squares of side 1 at `at`, which shows the image from texture coordinates `low` to `high`.
void add_sheet(TriangleMesh& mesh, int n, const glm::vec3& at, const glm::vec2& low, const glm::vec2& high) {
  const auto first = static_cast<VertexId>(mesh.positions.size());
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      mesh.positions.push_back(at + glm::vec3(x, y, 0));
      mesh.texture_coordinates.push_back(low + (high - low) * glm::vec2(x, y) / static_cast<float>(n));
    }
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const VertexId a = first + static_cast<VertexId>(y * (n + 1) + x), b = a + static_cast<VertexId>(n) + 1;
      mesh.triangles.emplace_back(a, a + 1, b);
      mesh.triangles.emplace_back(a + 1, b + 1, b);
    }
}

TriangleMesh textured(Texture texture) {
  TriangleMesh mesh;
  mesh.texture_origin = TextureOrigin::top_left;
  mesh.materials.emplace_back().texture = 0;
  mesh.textures.push_back(std::move(texture));
  return mesh;
}

SourceTextures sources_of(const hlod::Hlod& hlod, const std::filesystem::path& folder = {}) {
  return {hlod, folder, 1, [] {}};
}

// Samples RGBA bilinearly, as the image's bytes: texel (x, y) has its centre at (x + 1/2, y + 1/2).
glm::dvec4 bilinear(const Color& color, const glm::dvec2& at) {
  const glm::dvec2 corner = glm::floor(at - 0.5), t = at - 0.5 - corner;
  const auto texel = [&](int i, int j) {
    return glm::dvec4(color(static_cast<int>(corner.x) + i, static_cast<int>(corner.y) + j));
  };
  return glm::mix(glm::mix(texel(0, 0), texel(1, 0), t.x), glm::mix(texel(0, 1), texel(1, 1), t.x), t.y);
}

// Calls visit(texels of the source, texels of the tile's image) at places of all triangles, borders included.
template <typename Visit>
void sample_triangles(const TriangleMesh& before, const TriangleMesh& after, const glm::dvec2& source_size,
                      const TileImage& image, const Visit& visit) {
  const glm::dvec2 size(image.width, image.height);
  for (const Triangle& t : before.triangles)
    for (int i = 0; i <= 6; ++i)
      for (int j = 0; i + j <= 6; ++j) {
        const glm::dvec3 weights = glm::dvec3(6 - i - j, i, j) / 6.0;
        glm::dvec2 from(0.0), to(0.0);
        for (int k = 0; k < 3; ++k) {
          from += weights[k] * glm::dvec2(before.texture_coordinates[t[k]]);
          to += weights[k] * glm::dvec2(after.texture_coordinates[t[k]]);
        }
        visit(from * source_size, to * size);
      }
}

Color color_of(const TileImage& image) {
  return [&image](int x, int y) {
    x = std::clamp(x, 0, image.width - 1);
    y = std::clamp(y, 0, image.height - 1);
    return image.pixels[static_cast<std::size_t>(y * image.width + x)];
  };
}

// Two triangles that share an edge in space and in the image are one chart, whatever their normals, so that vertices
// are not shared; one that shares the edge in space only, or shows another image, is another.
TEST(Charts, JoinWhatMeetsInSpaceAndImage) {
  const std::vector<glm::vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  std::vector<glm::dvec2> texels{{0, 0}, {4, 0}, {0, 4}, {4, 0}, {4, 4}, {0, 4}};
  const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
  std::vector<std::uint32_t> images(6, 0);
  const std::vector<Chart> one = find_charts({positions, texels, images, triangles});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_DOUBLE_EQ(one[0].texels, 16.0);  // of the square with side 4
  EXPECT_DOUBLE_EQ(one[0].area, 1.0);
  EXPECT_DOUBLE_EQ(one[0].texel_size(), 0.25);
  EXPECT_EQ(one[0].texel_counts(), glm::i64vec2(4));
  images[3] = images[4] = images[5] = 1;
  EXPECT_EQ(find_charts({positions, texels, images, triangles}).size(), 2U);
  images = std::vector<std::uint32_t>(6, 0);
  for (std::size_t v = 3; v < 6; ++v) texels[v].x += 10.0;
  EXPECT_EQ(find_charts({positions, texels, images, triangles}).size(), 2U);
  images = {no_id, no_id, no_id, 0, 0, 0};
  EXPECT_EQ(find_charts({positions, texels, images, triangles}).size(), 1U);
}

// Every square that holds a point of the triangle is touched, once at most, and none outside of its box. Centred are
// the squares whose centres lie in it.
TEST(Charts, TouchedRowsHoldTheTriangle) {
  const std::vector<std::array<glm::dvec2, 3>> triangles{{{{0.2, 0.3}, {7.9, 2.1}, {3.5, 6.8}}},
                                                         {{{-3.5, 1.0}, {4.0, 1.0}, {0.0, 1.01}}},  // a sliver
                                                         {{{2.5, 2.5}, {2.5, 2.5}, {2.5, 2.5}}},
                                                         {{{1.0, -2.0}, {1.0, 5.0}, {1.0, 1.0}}}};
  for (const auto& [a, b, c] : triangles) {
    std::set<std::pair<std::int64_t, std::int64_t>> touched;
    for_each_touched_row(a, b, c, [&](std::int64_t y, std::int64_t x0, std::int64_t x1) {
      for (std::int64_t x = x0; x < x1; ++x) EXPECT_TRUE(touched.emplace(x, y).second) << x << ' ' << y;
    });
    for (int i = 0; i <= 200; ++i)
      for (int j = 0; i + j <= 200; ++j) {
        const glm::dvec2 on = (a * (200.0 - i - j) + b * static_cast<double>(i) + c * static_cast<double>(j)) / 200.0;
        const glm::dvec2 p = glm::mix(on, (a + b + c) / 3.0, 1e-9);  // off the lines of the grid
        EXPECT_TRUE(touched.contains({std::lround(std::floor(p.x)), std::lround(std::floor(p.y))}))
            << p.x << ' ' << p.y;
      }
    const glm::dvec2 low = glm::floor(glm::min(glm::min(a, b), c)), high = glm::floor(glm::max(glm::max(a, b), c));
    for (const auto& [x, y] : touched) {
      const glm::dvec2 at(static_cast<double>(x), static_cast<double>(y));
      EXPECT_TRUE(at == glm::clamp(at, low, high)) << x << ' ' << y;
    }
    const auto side = [](const glm::dvec2& p, const glm::dvec2& q, const glm::dvec2& r) {
      return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    };
    std::set<std::pair<std::int64_t, std::int64_t>> centered, inside;
    for_each_centered_row(a, b, c, [&](std::int64_t y, std::int64_t x0, std::int64_t x1) {
      for (std::int64_t x = x0; x < x1; ++x) EXPECT_TRUE(centered.emplace(x, y).second);
    });
    for (const auto& [x, y] : touched) {
      const glm::dvec2 at = glm::dvec2(static_cast<double>(x), static_cast<double>(y)) + 0.5;
      const double ab = side(a, b, at), bc = side(b, c, at), ca = side(c, a, at);
      if (side(a, b, c) != 0.0 && std::min({ab, bc, ca}) * std::max({ab, bc, ca}) >= 0.0) inside.emplace(x, y);
    }
    if (side(a, b, c) != 0.0) {
      EXPECT_EQ(centered, inside);
    }
  }
}

// What fits into a hollow lies there: a square of 2 x 2 in the corner that one of 4 x 4 lacks.
TEST(PackShapes, FillsHollows) {
  Shape corner(4, 4), square(2, 2);
  for (int y = 0; y < 4; ++y) corner.add(y, 0, y < 2 ? 4 : 2);
  for (int y = 0; y < 2; ++y) square.add(y, 0, 2);
  const Packing packing = pack_shapes(std::vector{square, corner});
  EXPECT_EQ(packing.size, glm::ivec2(4));
  EXPECT_EQ(packing.at[0], glm::ivec2(2));
  EXPECT_EQ(packing.at[1], glm::ivec2(0));
}

// Whatever the shapes, wider than a word too, none lies on another, and all lie in the image.
TEST(PackShapes, NoneOverlaps) {
  std::uint32_t random = 1;
  const auto next = [&](int end) {
    random = random * 1664525U + 1013904223U;
    return static_cast<int>((random >> 8U) % static_cast<std::uint32_t>(end));
  };
  for (int round = 0; round < 60; ++round) {
    std::vector<Shape> shapes;
    const int widest = round % 3 == 0 ? 150 : 20;
    for (int i = 0; i < 1 + round; ++i) {
      Shape& shape = shapes.emplace_back(1 + next(widest), 1 + next(20));
      for (int run = 0; run < 30; ++run) {
        const int x = next(shape.width());
        shape.add(next(shape.height()), x, x + 1 + next(shape.width() - x));
      }
    }
    const Packing packing = pack_shapes(shapes);
    std::set<std::pair<int, int>> taken;
    std::uint64_t squares = 0;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      for (int y = 0; y < shapes[i].height(); ++y)
        for (int x = 0; x < shapes[i].width(); ++x) {
          if (!shapes[i].has(x, y)) continue;
          const glm::ivec2 at = packing.at[i] + glm::ivec2(x, y);
          EXPECT_TRUE(taken.emplace(at.x, at.y).second);
          EXPECT_TRUE(at.x >= 0 && at.y >= 0 && at.x < packing.size.x && at.y < packing.size.y);
          ++squares;
        }
      squares -= shapes[i].count();
    }
    EXPECT_EQ(squares, 0U);
  }
}

// A tile of level 0 shows at every place what the input shows there, to the bit, up to the borders of its charts.
TEST(TileImage, FinestTilesShowTheSource) {
  TriangleMesh mesh = textured(texture_of(128, 128, own_color));
  add_sheet(mesh, 8, {0, 0, 0}, {0.11F, 0.07F}, {0.43F, 0.52F});
  add_sheet(mesh, 8, {20, 0, 0}, {0.9F, 0.9F}, {0.6F, 0.62F});
  const hlod::Hlod hlod = nested_hlod(mesh, 4096);
  const SourceTextures sources = sources_of(hlod);
  ASSERT_EQ(sources.images().size(), 1U);
  hlod::NodeId leaf = hlod.data().levels[0].first_node;
  const TriangleMesh before = tile_mesh(hlod, leaf, {}).mesh;
  TriangleMesh after = before;
  const TileImage image = make_tile_image(after, sources, 0.0);
  EXPECT_EQ(image.charts, 2U);
  EXPECT_EQ(image.texel_size, 0.0);
  EXPECT_EQ((image.width % 4) + (image.height % 4), 0);
  double worst = 0.0;
  sample_triangles(before, after, glm::dvec2(128.0), image, [&](const glm::dvec2& from, const glm::dvec2& to) {
    const glm::dvec4 shown = bilinear(color_of(image), to), wanted = bilinear(own_color, from);
    for (int k = 0; k < 4; ++k) worst = std::max(worst, std::abs(shown[k] - wanted[k]));
  });
  EXPECT_LT(worst, 0.05);  // floats of coordinates have a millionth of the image, times 255 between two texels
}

// Where the chart is one colour, a coarse tile shows that colour everywhere, at its borders too: neither what lies
// beside the chart in the source nor what no triangle shows bleeds in.
TEST(TileImage, NothingBleedsIntoCharts) {
  const glm::u8vec4 red(200, 30, 10, 255), green(20, 180, 40, 255), unused(255, 0, 255, 255);
  TriangleMesh mesh = textured(texture_of(256, 256, [&](int x, int y) {
    const bool is_red = x >= 16 && x < 112 && y >= 16 && y < 240, is_green = x >= 128 && x < 240 && y >= 16 && y < 240;
    return is_red ? red : is_green ? green : unused;
  }));
  add_sheet(mesh, 8, {0, 0, 0}, glm::vec2(16.0F, 16.0F) / 256.0F, glm::vec2(112.0F, 240.0F) / 256.0F);
  add_sheet(mesh, 8, {20, 0, 0}, glm::vec2(128.0F, 16.0F) / 256.0F, glm::vec2(240.0F, 240.0F) / 256.0F);
  const hlod::Hlod hlod = nested_hlod(mesh, 4096);
  const SourceTextures sources = sources_of(hlod);
  const TriangleMesh before = tile_mesh(hlod, hlod.data().levels[0].first_node, {}).mesh;
  for (const double texel_size : {0.1, 0.3, 0.8, 3.0}) {
    TriangleMesh after = before;
    const TileImage image = make_tile_image(after, sources, texel_size);
    EXPECT_GT(image.texel_size, 0.5 * texel_size);
    EXPECT_LT(image.texel_size, 2.0 * texel_size);
    sample_triangles(before, after, glm::dvec2(256.0), image, [&](const glm::dvec2& from, const glm::dvec2& to) {
      const glm::dvec4 shown = bilinear(color_of(image), to), wanted(from.x < 120.0 ? red : green);
      EXPECT_LT(glm::length(shown - wanted), 1.5) << texel_size;
    });
  }
}

// Means are of light: half black and half white is 188 of 255, not 128. Transparent texels have no colour.
TEST(TileImage, MeansAreOfLight) {
  TexelMean gray;
  gray.add({0, 0, 0, 255}, 1.0F);
  gray.add({255, 255, 255, 255}, 1.0F);
  EXPECT_EQ(gray.value(), glm::u8vec4(188, 188, 188, 255));
  TexelMean leaf;
  leaf.add({10, 200, 30, 255}, 1.0F);
  leaf.add({255, 0, 255, 0}, 1.0F);
  EXPECT_EQ(leaf.value(), glm::u8vec4(10, 200, 30, 128));
  for (int i = 0; i < 256; ++i) {
    const auto value = static_cast<std::uint8_t>(i);
    EXPECT_EQ(srgb_of(linear_of(value)), value);
  }
}

// An image that is repeated stays shared, and so does one of a material with further maps; both say why.
TEST(SourceTextures, WhatRepeatsStaysShared) {
  TriangleMesh bricks = textured(texture_of(64, 64, own_color));
  add_sheet(bricks, 8, {0, 0, 0}, {0, 0}, {5, 5});
  const hlod::Hlod wall = nested_hlod(bricks);
  const SourceTextures repeated = sources_of(wall);
  EXPECT_TRUE(repeated.images().empty());
  ASSERT_EQ(repeated.shared().size(), 1U);
  EXPECT_NE(repeated.shared()[0].reason.find("times its texels"), std::string::npos);
  EXPECT_EQ(repeated.image_of(0), no_id);

  TriangleMesh sheet = textured(texture_of(64, 64, own_color));
  add_sheet(sheet, 8, {0, 0, 0}, {0, 0}, {1, 1});
  EXPECT_EQ(sources_of(nested_hlod(sheet, 4096)).images().size(), 1U);
  sheet.materials[0].surface.normal_map.texture = 0;
  const SourceTextures mapped = sources_of(nested_hlod(sheet, 4096));
  EXPECT_TRUE(mapped.images().empty());
  EXPECT_EQ(mapped.shared().at(0).reason, "a material has further maps");
}

// Under a memory limit the texels of many small images can leave main memory, too: all sizes of all images, 256^2 +
// 128^2
// + ... + 1 each, lie in scratch files.
TEST(SourceTextures, SmallImagesLieInScratchFiles) {
  TriangleMesh mesh = textured(texture_of(256, 256, own_color));
  constexpr std::size_t images = 32;
  for (std::size_t i = 0; i < images; ++i) {
    mesh.textures.resize(images, mesh.textures[0]);
    mesh.materials.resize(images);
    mesh.materials[i].texture = static_cast<TextureId>(i);
    add_sheet(mesh, 2, {4 * i, 0, 0}, {0, 0}, {1, 1});
    mesh.triangle_materials.resize(mesh.triangles.size(), static_cast<MaterialId>(i));
  }
  const hlod::Hlod hlod = nested_hlod(mesh, 4096);
  const Folder folder;
  const MemoryLimit limit(std::size_t{8} << 30U, folder / "");
  const SourceTextures sources = sources_of(hlod);
  ASSERT_EQ(sources.images().size(), images);
  EXPECT_GE(limit.max_scratch_bytes(), images * 87'381 * sizeof(glm::u8vec4));
}

// A chart may lie across the edge of an image that repeats: it shows what lies there.
TEST(TileImage, ChartsMayCrossTheEdgeOfAnImage) {
  TriangleMesh mesh = textured(texture_of(128, 128, own_color));
  add_sheet(mesh, 8, {0, 0, 0}, {-0.3F, 1.6F}, {0.3F, 2.4F});
  const hlod::Hlod hlod = nested_hlod(mesh, 4096);
  const SourceTextures sources = sources_of(hlod);
  ASSERT_EQ(sources.images().size(), 1U);
  const TriangleMesh before = tile_mesh(hlod, hlod.data().levels[0].first_node, {}).mesh;
  TriangleMesh after = before;
  const TileImage image = make_tile_image(after, sources, 0.0);
  const auto repeated = [](int x, int y) { return own_color((x % 128 + 128) % 128, (y % 128 + 128) % 128); };
  sample_triangles(before, after, glm::dvec2(128.0), image, [&](const glm::dvec2& from, const glm::dvec2& to) {
    EXPECT_LT(glm::length(bilinear(color_of(image), to) - bilinear(repeated, from)), 0.2);
  });
}

// Tiles together have no more than 4/3 of the texels of the finest, since each level has less than a quarter of those
// of the level below, those that only have coarser images included. Any number of threads writes the same files.
TEST(WriteTileset, ImagesOfTiles) {
  TriangleMesh mesh = textured(texture_of(512, 512, own_color));
  add_sheet(mesh, 64, {0, 0, 0}, {0.02F, 0.02F}, {0.98F, 0.98F});
  for (glm::vec3& p : mesh.positions) p.z = 9.0F * std::sin(0.3F * p.x) * std::cos(0.2F * p.y);
  const hlod::Hlod hlod = nested_hlod(mesh, 512);
  const Folder folder;
  TilesetOptions options;
  options.threads = 1;
  const TilesetCounts counts = write_tileset(folder / "one", hlod, options);
  options.threads = 5;
  write_tileset(folder / "five", hlod, options);
  EXPECT_TRUE(counts.images_shared.empty());
  EXPECT_EQ(counts.source_texels, 512U * 512U);
  EXPECT_FALSE(std::filesystem::exists(folder / "one/textures"));
  std::size_t leaf_texels = 0, other_texels = 0;
  for (hlod::NodeId n = 0; n < hlod.node_count(); ++n) {
    const auto one = read_whole(folder / ("one/" + content_name(n))),
               five = read_whole(folder / ("five/" + content_name(n)));
    EXPECT_EQ(one, five) << n;
    const TriangleMesh tile = test::read_content(folder / ("one/" + content_name(n)));
    ASSERT_EQ(tile.textures.size(), 1U);
    EXPECT_EQ(tile.textures[0].mime_type, "image/png");
    EXPECT_EQ(tile.textures[0].wrap_s, TextureWrap::clamp);
    const ImageSize size = size_of_image(tile.textures[0].bytes, "tile");
    (hlod.node(n).level == 0 ? leaf_texels : other_texels) +=
        static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
    for (const glm::vec2& uv : tile.texture_coordinates)
      EXPECT_TRUE(uv.x > 0.0F && uv.x < 1.0F && uv.y > 0.0F && uv.y < 1.0F);
  }
  EXPECT_LT(other_texels, leaf_texels / 2);
  EXPECT_GT(counts.tiles, hlod.node_count());
  EXPECT_GT(counts.texels, leaf_texels + other_texels);
  EXPECT_LT(static_cast<double>(counts.texels), 1.5 * static_cast<double>(leaf_texels));
}

// A tileset of a file whose nodes have images needs none of the input: its finest tiles have those of their nodes, byte
// for byte, and tiles show at their vertices what the input shows there, as far as their texels can: red grows by one
// every two texels along x, green along y.
TEST(WriteTileset, TakesImagesOfNodes) {
  TriangleMesh mesh = textured(texture_of(512, 512, [](int x, int y) { return glm::u8vec4(x / 2, y / 2, 40, 255); }));
  add_sheet(mesh, 64, {0, 0, 0}, {0.02F, 0.02F}, {0.98F, 0.98F});
  for (glm::vec3& p : mesh.positions) p.z = 9.0F * std::sin(0.3F * p.x) * std::cos(0.2F * p.y);
  const Folder folder;
  write_ohlod(folder / "sheet.ohlod", nested_hlod(mesh, 512), {}, {.images = OhlodImages::nodes});
  const hlod::Hlod whole = read_ohlod(folder / "sheet.ohlod").hlod;
  whole.require_all();
  hlod::HlodData data = hlod::copy_data(whole);
  data.textures[0].bytes.clear();
  data.textures[0].file = "gone.png";
  const hlod::Hlod hlod = hlod::make_hlod(std::move(data));
  const TilesetCounts counts = write_tileset(folder / "tiles", hlod, {});
  EXPECT_TRUE(counts.images_left_out.empty());
  EXPECT_TRUE(counts.images_shared.empty());
  EXPECT_GT(counts.tiles, hlod.node_count());  // some have coarser images, too
  constexpr double source_texel = 64.0 / (0.96 * 512.0);
  std::uint64_t texels = 0, tiles = 0;
  for (hlod::NodeId n = 0; n < hlod.node_count(); ++n)
    for (std::size_t coarser = 0; std::filesystem::exists(folder / ("tiles/" + content_name(n, coarser))); ++coarser) {
      ++tiles;
      const TriangleMesh tile = test::read_content(folder / ("tiles/" + content_name(n, coarser)));
      ASSERT_EQ(tile.textures.size(), 1U);
      EXPECT_EQ(std::ranges::equal(tile.textures[0].bytes, hlod.mesh(n).image), coarser == 0) << n;
      const Texels image = decode_texels(tile.textures[0].bytes, "image");
      texels += image.pixels.size();
      const double texel = std::max<double>(hlod.data().node_images[n].texel_size, source_texel) *
                           std::pow(2.5, static_cast<double>(coarser));
      const double most = 2.5 + 0.75 * texel / source_texel;  // one and a half texels
      for (const Triangle& t : tile.triangles)
        for (int k = 0; k < 3; ++k) {
          const glm::ivec2 at(glm::dvec2(tile.texture_coordinates[t[k]]) * glm::dvec2(image.width, image.height));
          const glm::u8vec4 shown = image.pixels[static_cast<std::size_t>(at.y * image.width + at.x)];
          const glm::dvec2 place = 0.02 + 0.96 * glm::dvec2(tile.positions[t[k]]) / 64.0;
          EXPECT_NEAR(shown.r, 256.0 * place.x, most) << n << " " << coarser;
          EXPECT_NEAR(shown.g, 256.0 * place.y, most) << n << " " << coarser;
        }
    }
  EXPECT_EQ(tiles, counts.tiles);
  EXPECT_EQ(texels, counts.texels);
}

TEST(WriteTileset, JpegWhereAllIsOpaque) {
  const Folder folder;
  TilesetOptions options;
  options.texture_format = TextureFormat::jpeg;
  for (const int alpha : {255, 100}) {
    TriangleMesh mesh = textured(texture_of(64, 64, [&](int x, int y) {
      glm::u8vec4 color = own_color(x, y);
      color.a = static_cast<std::uint8_t>(alpha);
      return color;
    }));
    add_sheet(mesh, 8, {0, 0, 0}, {0, 0}, {1, 1});
    options.replace = alpha != 255;
    write_tileset(folder / "tiles", nested_hlod(mesh, 4096), options);
    const TriangleMesh tile = test::read_content(folder / ("tiles/" + content_name(0)));
    EXPECT_EQ(tile.textures.at(0).mime_type, alpha == 255 ? "image/jpeg" : "image/png");
  }
}

}  // namespace
}  // namespace occlod::tiles
