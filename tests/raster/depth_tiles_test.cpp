// Pixels of boxes that pass the depth test, against rays through the middle of each pixel.
#include "raster/depth_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <optional>
#include <random>
#include <vector>

#include "occlod/bounds.h"
#include "occlod/view.h"

namespace occlod::raster {
namespace {

constexpr int width = 83, height = 61;  // no multiple of a tile

Camera camera(bool orthographic) {
  Camera camera{.eye = {0.0, 0.0, 5.0}, .width = width, .height = height, .near = 0.5, .far = 20.0};
  if (orthographic) camera.orthographic_height = 4.0;
  return camera;
}

// A box that an affine map takes into the world.
struct PlacedBox {
  Box box;
  glm::dmat4 to_world;
};

ProjectedBox project(const View& view, const PlacedBox& placed) {
  ProjectedBox result;
  result.mirrored = glm::determinant(glm::dmat3(placed.to_world)) < 0.0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 clip = view.world_to_clip() * placed.to_world * glm::dvec4(corner(placed.box, i), 1.0);
    const double nearness = view.is_orthographic() ? (clip.w - clip.z) / 2.0 : 1.0 / clip.w;
    result.corners[static_cast<std::size_t>(i)] = {(clip.x / clip.w + 1.0) / 2.0 * width,
                                                   (1.0 - clip.y / clip.w) / 2.0 * height, nearness};
  }
  return result;
}

struct Hit {
  double nearness;
  bool certain;  // the ray passes no closer than a 1e-6 of the box's size by its border
};

// Where the ray through the middle of a pixel enters the box: slabs in the box's own space.
std::optional<Hit> hit_of(const View& view, const PlacedBox& placed, int x, int y) {
  const glm::dmat4 from_clip = glm::inverse(view.world_to_clip() * placed.to_world);
  const auto at = [&](double z) {
    const glm::dvec4 p = from_clip * glm::dvec4((x + 0.5) / width * 2.0 - 1.0, 1.0 - (y + 0.5) / height * 2.0, z, 1.0);
    return glm::dvec3(p) / p.w;
  };
  const glm::dvec3 begin = at(-1.0), end = at(1.0);
  double first = -1e300, last = 1e300;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (placed.box.min[axis] - begin[axis]) / (end[axis] - begin[axis]);
    const double b = (placed.box.max[axis] - begin[axis]) / (end[axis] - begin[axis]);
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  if (first > last + 1e-6) return std::nullopt;
  const glm::dvec4 clip = view.world_to_clip() * placed.to_world * glm::dvec4(begin + first * (end - begin), 1.0);
  return Hit{view.is_orthographic() ? (clip.w - clip.z) / 2.0 : 1.0 / clip.w, first < last - 1e-6};
}

class RandomBoxes {
 public:
  explicit RandomBoxes(std::uint32_t seed) : random_(seed) {}

  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  // From needles and sheets to boxes as large as the image, all before the near plane, some beside the image.
  PlacedBox next() {
    const auto half = [&] { return static_cast<float>(std::exp(in(std::log(0.02), std::log(1.2)))); };
    const glm::vec3 size(half(), half(), half());
    const glm::dvec3 axis(in(-1, 1), in(-1, 1), in(-1, 1));
    glm::dmat4 to_world = glm::translate(glm::dmat4(1.0), glm::dvec3(in(-3, 3), in(-2, 2), in(-8, 1.5)));
    if (in(0, 1) < 0.7) to_world = glm::rotate(to_world, in(0, 6), axis + glm::dvec3(1e-3));
    if (in(0, 1) < 0.3) to_world = glm::scale(to_world, {-1, 1, 1});
    return {{-size, size}, to_world};
  }

 private:
  std::mt19937 random_;
};

// A picture of slopes and steps at the depths where the boxes are, with empty parts.
void fill(const DepthImage& image, const View& view, RandomBoxes& random) {
  const double a = random.in(-1, 1), b = random.in(-1, 1), distance = random.in(3, 9);
  const int hole = static_cast<int>(random.in(0, width)), step = static_cast<int>(random.in(1, 30));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double z =
          std::clamp(distance + (a * x / width + b * y / height) * 4.0 + (x / step + y / step) % 3, 0.5, 20.0);
      const double nearness = view.is_orthographic() ? (20.0 - z) / 19.5 : 1.0 / z;
      image.nearness[y * image.stride + x] = x > hole && x < hole + 15 ? 0.0F : static_cast<float>(nearness);
    }
}

struct Frame {
  explicit Frame(bool orthographic) : view(camera(orthographic)), memory(96 * height) {
    image = {memory.data(), width, height, 96};
    tiles.begin(image);
  }
  View view;
  std::vector<float> memory;
  DepthImage image;
  DepthTiles tiles;
};

// Pixels that the box certainly covers and where it certainly passes, and those where it may.
struct Bounds {
  std::uint32_t covered = 0, may_cover = 0, passed = 0, may_pass = 0;
};

Bounds by_rays(const Frame& frame, const PlacedBox& box) {
  Bounds bounds;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto hit = hit_of(frame.view, box, x, y);
      if (!hit) continue;
      const double depth = frame.image.nearness[y * frame.image.stride + x];
      ++bounds.may_cover;
      if (hit->certain) ++bounds.covered;
      if (depth <= hit->nearness * (1.0 + 1e-9) + 1e-9) ++bounds.may_pass;
      // A face seen so nearly edge-on that it covers nothing is left out, which is nearer by up to its own width.
      if (hit->certain && depth <= hit->nearness * (1.0 - 1e-9)) ++bounds.passed;
    }
  return bounds;
}

TEST(DepthTiles, CountWhatRaysFind) {
  RandomBoxes random(1);
  std::uint32_t covered = 0, passed = 0, hidden = 0;
  for (int n = 0; n < 600; ++n) {
    Frame frame(n % 3 == 0);
    fill(frame.image, frame.view, random);
    frame.tiles.change({0, 0, width, height});
    const PlacedBox box = random.next();
    const DepthCount count = frame.tiles.count(project(frame.view, box));
    const Bounds bounds = by_rays(frame, box);
    ASSERT_GE(count.covered, bounds.covered) << n;
    ASSERT_LE(count.covered, bounds.may_cover) << n;
    ASSERT_GE(count.passed, bounds.passed) << n;
    ASSERT_LE(count.passed, bounds.may_pass) << n;
    covered += count.covered;
    passed += count.passed;
    hidden += count.covered > 0 && count.passed == 0 ? 1 : 0;
  }
  // The cases are worth something.
  EXPECT_GT(covered, 30'000U);
  EXPECT_GT(passed, covered / 5);
  EXPECT_LT(passed, covered * 4 / 5);
  EXPECT_GT(hidden, 20U);
}

// Tiles may say that all or none of their pixels pass only where that is so for every one.
TEST(DepthTiles, DecideAsTheirPixelsDo) {
  RandomBoxes random(2);
  Frame frame(false);
  for (int n = 0; n < 2000; ++n) {
    if (n % 20 == 0) {
      fill(frame.image, frame.view, random);
      frame.tiles.change({0, 0, width, height});
    }
    const ProjectedBox box = project(frame.view, random.next());
    BoxOutline outline;
    outline.assign(box, width, height);
    const BoxFront front(box);
    std::uint32_t passed = 0, covered = 0;
    for (int y = outline.first_row(); y < outline.end_row(); ++y)
      for (int x = outline.span(y).begin; x < outline.span(y).end; ++x) {
        passed += frame.image.nearness[y * frame.image.stride + x] <= front.row(y).at(x) ? 1U : 0U;
        ++covered;
      }
    const DepthCount count = frame.tiles.count(box);
    ASSERT_EQ(count.passed, passed) << n;
    ASSERT_EQ(count.covered, covered) << n;
    ASSERT_EQ(outline.pixels(), covered) << n;
  }
}

// What is drawn later is seen, in every tile that it touches and in no other.
TEST(DepthTiles, SeeWhatIsDrawnBetweenCounts) {
  Frame frame(false);
  const PlacedBox box{{glm::vec3(-1.0F), glm::vec3(1.0F)}, glm::dmat4(1.0)};
  const ProjectedBox image = project(frame.view, box);
  const std::uint32_t all = frame.tiles.count(image).passed;
  EXPECT_EQ(all, frame.tiles.count(image).covered);
  // One pixel in the middle, nearer than anything.
  frame.image.nearness[30 * frame.image.stride + 40] = 1.0F;
  frame.tiles.change({40, 30, 41, 31});
  EXPECT_EQ(frame.tiles.count(image).passed, all - 1);
  std::fill(frame.memory.begin(), frame.memory.end(), 1.0F);
  frame.tiles.change({0, 0, width, height});
  EXPECT_EQ(frame.tiles.count(image).passed, 0U);
  frame.tiles.begin(frame.image);
  EXPECT_EQ(frame.tiles.count(image).passed, 0U);
}

// An equal depth passes: what touches the surface is visible.
TEST(DepthTiles, LetEqualDepthsPass) {
  Frame frame(true);
  // 0.25 is exact in every step; the box's front faces the eye.
  ProjectedBox box;
  for (int i = 0; i < 8; ++i)
    box.corners[static_cast<std::size_t>(i)] = {(i & 1) != 0 ? 30.0 : 10.0, (i & 2) != 0 ? 10.0 : 30.0,
                                                (i & 4) != 0 ? 0.25 : 0.125};
  std::fill(frame.memory.begin(), frame.memory.end(), 0.25F);
  frame.tiles.change({0, 0, width, height});
  EXPECT_EQ(frame.tiles.count(box).passed, 400U);
  std::fill(frame.memory.begin(), frame.memory.end(), std::nextafter(0.25F, 1.0F));
  frame.tiles.change({0, 0, width, height});
  EXPECT_EQ(frame.tiles.count(box).passed, 0U);
}

// Twenty pixels by none, by a thousandth of one, and in one point: what they cover is what lies between pixel centres.
TEST(BoxOutline, OfFlatBoxesHoldsTheCentresBetweenItsSides) {
  const auto pixels = [](double x0, double x1, double y0, double y1) {
    ProjectedBox box;
    for (int i = 0; i < 8; ++i)
      box.corners[static_cast<std::size_t>(i)] = {(i & 1) != 0 ? x1 : x0, (i & 2) != 0 ? y1 : y0, 0.5};
    BoxOutline outline;
    outline.assign(box, width, height);
    return outline.pixels();
  };
  EXPECT_EQ(pixels(10, 30, 10, 10), 0U);
  EXPECT_EQ(pixels(10, 30, 10.4999, 10.5001), 20U);
  EXPECT_EQ(pixels(10.4999, 10.5001, 10, 30), 20U);
  EXPECT_EQ(pixels(10.5, 11.5, 10.5, 11.5), 1U);  // half open
  EXPECT_EQ(pixels(10.6, 10.6, 10.6, 10.6), 0U);
  EXPECT_EQ(pixels(-1e6, 1e6, -1e6, 1e6), static_cast<std::uint32_t>(width * height));
  EXPECT_EQ(pixels(-20, -10, 10, 30), 0U);
  EXPECT_EQ(pixels(10, 30, 70, 90), 0U);
}

}  // namespace
}  // namespace occlod::raster
