#include "raster/draw_bands.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <random>
#include <span>
#include <vector>

#include "raster/every_target.h"
#include "raster/pixel_space.h"

namespace occlod {
namespace {

using raster::BandDrawing;
using raster::DrawPart;

constexpr int width = 333, height = 257;

// A cloud of triangles of all sizes, also such as are beside the image, before the near plane or without area.
struct Cloud {
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
};

Cloud random_cloud(std::mt19937& random, std::size_t triangles) {
  std::uniform_real_distribution<float> unit(0.0F, 1.0F), depth(-1.2F, 1.0F);
  Cloud cloud;
  for (std::size_t i = 0; i < triangles; ++i) {
    const float size = i % 100 == 0 ? 400.0F : i % 10 == 0 ? 90.0F : 12.0F;
    const glm::vec3 at(1.2F * width * unit(random) - 30.0F, 1.2F * height * unit(random) - 30.0F, depth(random));
    const auto first = static_cast<VertexId>(cloud.positions.size());
    for (int k = 0; k < 3; ++k)
      cloud.positions.push_back(at + glm::vec3(size * unit(random), size * unit(random), 0.3F * unit(random)));
    cloud.triangles.emplace_back(first, first + 1, i % 50 == 7 ? first : first + 2);
  }
  return cloud;
}

class DrawBands : public ::testing::Test {
 protected:
  void SetUp() override {
    std::mt19937 random(5);
    clouds_ = {random_cloud(random, 9000), random_cloud(random, 10), random_cloud(random, 4000)};
    glm::mat4 to_clip = test::pixel_to_clip(width, height);
    to_clip[2][3] = 1.0F;  // w = 2 + z
    to_clip[3][3] = 2.0F;
    std::uint32_t item = 0;
    for (const Cloud& cloud : clouds_) {
      parts_.push_back({cloud.positions, cloud.triangles, to_clip, item});
      item += static_cast<std::uint32_t>(cloud.triangles.size());
    }
    expected_.reset(width, height);
    for (const DrawPart& part : parts_)
      draw_items(expected_, part.positions, part.triangles, part.object_to_clip, part.first_item);
  }

  std::vector<Cloud> clouds_;
  std::vector<DrawPart> parts_;
  ItemBuffer expected_;
};

TEST_F(DrawBands, DrawTheSameItemsByAnyNumberOfThreads) {
  BandDrawing drawing;
  for (const unsigned threads : {1U, 2U, 3U, 8U, 300U}) {
    ItemBuffer items;
    items.reset(width, height);
    drawing.draw_items(items, parts_, threads);
    EXPECT_EQ(items.items, expected_.items) << threads;
    EXPECT_EQ(items.depth.nearness, expected_.depth.nearness) << threads;
  }
}

TEST_F(DrawBands, DrawTheSameDepthOnEveryMachine) {
  test::for_every_target([&](const char* target) {
    for (const unsigned threads : {1U, 2U, 5U}) {
      DepthBuffer depth;
      depth.reset(width, height);
      const PixelRect drawn = BandDrawing().draw_depth({depth.nearness.data(), width, height, width}, parts_, threads);
      ASSERT_EQ(depth.nearness, expected_.depth.nearness) << target << ", " << threads;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const bool inside = x >= drawn.x0 && x < drawn.x1 && y >= drawn.y0 && y < drawn.y1;
          ASSERT_TRUE(inside || depth.nearness[static_cast<std::size_t>(y * width + x)] == 0.0F);
        }
    }
  });
}

TEST_F(DrawBands, DrawsOnlyTheRowsOfAnImage) {
  DepthBuffer depth;
  depth.reset(width, height);
  DepthImage image{depth.nearness.data(), width, height, width, {100, 130}};
  for (const DrawPart& part : parts_) draw_depth(image, part.positions, part.triangles, part.object_to_clip);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto pixel = static_cast<std::size_t>(y * width + x);
      ASSERT_EQ(depth.nearness[pixel], y >= 100 && y < 130 ? expected_.depth.nearness[pixel] : 0.0F);
    }
}

}  // namespace
}  // namespace occlod
