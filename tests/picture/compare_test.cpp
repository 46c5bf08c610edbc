// Distances between pictures that can be worked out by hand.
#include "occlod/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "picture/quads.h"

namespace occlod {
namespace {

using test::front_view;
using test::parallel_view;

constexpr std::size_t pixels = 100 * 80;

DepthBuffer flat(double w) {
  DepthBuffer depth;
  depth.reset(100, 80);
  std::fill(depth.nearness.begin(), depth.nearness.end(), static_cast<float>(1.0 / w));
  return depth;
}

Image gray(std::uint8_t level) {
  return {100, 80, std::vector<glm::u8vec4>(pixels, glm::u8vec4(level, level, level, 255))};
}

TEST(ComparePictures, OfTheSameIsNothing) {
  const PictureDistance d = compare_pictures(front_view(), flat(3), gray(9), flat(3), gray(9));
  EXPECT_EQ(d.depth_rms_px, 0.0);
  EXPECT_EQ(d.silhouette_mismatch, 0.0);
  EXPECT_EQ(d.psnr_y, std::numeric_limits<double>::infinity());
}

TEST(ComparePictures, OfAShiftedPlaneIsTheShiftInPixels) {
  // 0.5 units at depth 10 with f = 40 px cover 40 * 0.5 / 10 = 2 px, nearer or farther; at depth 5 they cover 4 px.
  EXPECT_NEAR(compare_pictures(front_view(), flat(10.5), gray(9), flat(10), gray(9)).depth_rms_px, 2.0, 1e-4);
  EXPECT_NEAR(compare_pictures(front_view(), flat(9.5), gray(9), flat(10), gray(9)).depth_rms_px, 2.0, 1e-4);
  EXPECT_NEAR(compare_pictures(front_view(), flat(5.5), gray(9), flat(5), gray(9)).depth_rms_px, 4.0, 1e-4);
}

// What parallel rays see at one distance.
DepthBuffer parallel_flat(double distance) { return flat(100.0 / (101.0 - distance)); }

// 0.5 units cover 5 px anywhere.
TEST(ComparePictures, OfAShiftedPlaneSeenByParallelRays) {
  for (const double distance : {5.0, 50.0})
    EXPECT_NEAR(
        compare_pictures(parallel_view(), parallel_flat(distance + 0.5), gray(9), parallel_flat(distance), gray(9))
            .depth_rms_px,
        5.0, 1e-3);
}

TEST(ComparePictures, CapsEachPixelAtTen) {
  // A quarter of the pixels is 1000 units off, the rest equal: sqrt(100 / 4).
  DepthBuffer depth = flat(10);
  std::fill_n(depth.nearness.begin(), pixels / 4, 0.001F);
  EXPECT_NEAR(compare_pictures(front_view(), depth, gray(9), flat(10), gray(9)).depth_rms_px, 5.0, 1e-9);
}

TEST(ComparePictures, CountsTheSilhouetteAgainstTheReference) {
  // The reference covers 4000 pixels; 100 of them are missing and 300 are covered that it does not cover: 400 / 4000.
  DepthBuffer depth = flat(10), reference = flat(10);
  std::fill_n(reference.nearness.begin(), pixels / 2, 0.0F);
  std::fill_n(depth.nearness.begin(), pixels / 2 - 300, 0.0F);
  std::fill_n(depth.nearness.end() - 100, 100, 0.0F);
  const PictureDistance d = compare_pictures(front_view(), depth, gray(9), reference, gray(9));
  EXPECT_NEAR(d.silhouette_mismatch, 10.0, 1e-9);
  EXPECT_EQ(d.depth_rms_px, 0.0);  // where both cover they agree
}

TEST(ComparePictures, OfNothingAndSomething) {
  DepthBuffer nothing;
  nothing.reset(100, 80);
  EXPECT_EQ(compare_pictures(front_view(), nothing, gray(9), nothing, gray(9)).silhouette_mismatch, 0.0);
  EXPECT_EQ(compare_pictures(front_view(), nothing, gray(9), flat(3), gray(9)).silhouette_mismatch, 100.0);
  EXPECT_EQ(compare_pictures(front_view(), flat(3), gray(9), nothing, gray(9)).silhouette_mismatch,
            std::numeric_limits<double>::infinity());
}

TEST(ComparePictures, MeasuresLuma) {
  // Gray 10 levels apart: 20 log10(255 / 10). Green alone counts 0.587 of that.
  EXPECT_NEAR(compare_pictures(front_view(), flat(3), gray(100), flat(3), gray(110)).psnr_y, 20.0 * std::log10(25.5),
              1e-9);
  Image green = gray(100);
  for (glm::u8vec4& p : green.pixels) p.y = 110;
  EXPECT_NEAR(compare_pictures(front_view(), flat(3), green, flat(3), gray(100)).psnr_y,
              20.0 * std::log10(25.5 / 0.587), 1e-9);
}

TEST(ComparePictures, MeasuresColourDifferences) {
  // JPEG's Cb of blue alone is half its level, its Cr -0.114 / 1.402 of it (B - Y = 0.886 B, over 1.772; R - Y = -0.114
  // B, over 1.402). Gray has none of either.
  Image blue = gray(100);
  for (glm::u8vec4& p : blue.pixels) p.z = 120;
  const PictureDistance d = compare_pictures(front_view(), flat(3), blue, flat(3), gray(100));
  EXPECT_NEAR(d.psnr_cb, 20.0 * std::log10(255.0 / 10.0), 1e-9);
  EXPECT_NEAR(d.psnr_cr, 20.0 * std::log10(255.0 / (20.0 * 0.114 / 1.402)), 1e-9);
  const PictureDistance of_gray = compare_pictures(front_view(), flat(3), gray(110), flat(3), gray(100));
  EXPECT_GT(of_gray.psnr_cb, 200.0);  // 0 but for rounding
  EXPECT_GT(of_gray.psnr_cr, 200.0);
}

// A step in depth from 10 to 20 at column `edge`.
DepthBuffer step(int edge) {
  DepthBuffer depth = flat(20);
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < edge; ++x) depth.nearness[static_cast<std::size_t>(100 * y + x)] = 0.1F;
  return depth;
}

TEST(CountUnexplainedPixels, DepthMayDifferByWhatIsAllowed) {
  // f = 40 px: 2 px at depth 10 are 0.5 units.
  EXPECT_EQ(count_unexplained_pixels(front_view(), flat(10), flat(10.45), 2.0), 0U);
  EXPECT_EQ(count_unexplained_pixels(front_view(), flat(10), flat(10.55), 2.0), pixels);
  EXPECT_EQ(count_unexplained_pixels(front_view(), flat(10), flat(9.55), 2.0), 0U);
  EXPECT_EQ(count_unexplained_pixels(front_view(), flat(10), flat(9.45), 2.0), pixels);
}

// 2 px are 0.2 units; background is infinitely far.
TEST(CountUnexplainedPixels, DepthMayDifferForParallelRaysToo) {
  const View view = parallel_view();
  DepthBuffer nothing;
  nothing.reset(100, 80);
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(count_unexplained_pixels(view, parallel_flat(10), parallel_flat(10 + 0.19 * sign), 2.0), 0U);
    EXPECT_EQ(count_unexplained_pixels(view, parallel_flat(10), parallel_flat(10 + 0.21 * sign), 2.0), pixels);
    EXPECT_NEAR(largest_motion_px(view, parallel_flat(10), parallel_flat(10 + 0.15 * sign)), 1.5, 1e-3);
  }
  EXPECT_EQ(count_unexplained_pixels(view, nothing, parallel_flat(100.9), 50.0), pixels);
  EXPECT_EQ(count_unexplained_pixels(view, parallel_flat(100.9), nothing, 50.0), pixels);
  EXPECT_EQ(count_unexplained_pixels(view, nothing, nothing, 2.0), 0U);
}

TEST(CountUnexplainedPixels, SilhouettesMayMoveByWhatIsAllowed) {
  // The step moved by 2 columns: all explained at 2 px. By 5: in each of 80 rows columns 52, 53, 54 are nearer than
  // anything within 2 px.
  EXPECT_EQ(count_unexplained_pixels(front_view(), step(52), step(50), 2.0), 0U);
  EXPECT_EQ(count_unexplained_pixels(front_view(), step(55), step(50), 2.0), 3U * 80U);
  EXPECT_EQ(count_unexplained_pixels(front_view(), step(50), step(55), 2.0), 3U * 80U);  // and farther
}

TEST(CountUnexplainedPixels, BackgroundIsInfinitelyFar) {
  DepthBuffer hole = flat(10);
  for (std::size_t y = 20; y < 30; ++y)
    std::fill_n(hole.nearness.begin() + static_cast<std::ptrdiff_t>(100 * y + 20), 10, 0.0F);
  // A hole of 10 x 10 that should not be there: all but a rim of 1 px is unexplained.
  EXPECT_EQ(count_unexplained_pixels(front_view(), flat(10), hole, 1.0), 8U * 8U);
  // A hole that is missing: every one of its pixels.
  EXPECT_EQ(count_unexplained_pixels(front_view(), hole, flat(10), 1.0), 100U);
  EXPECT_EQ(count_unexplained_pixels(front_view(), hole, hole, 0.0), 0U);
}

TEST(CountLostPixels, AllButARimOfAWideSurface) {
  DepthBuffer hole = flat(10);
  for (std::size_t y = 20; y < 30; ++y)
    std::fill_n(hole.nearness.begin() + static_cast<std::ptrdiff_t>(100 * y + 20), 10, 0.0F);
  EXPECT_EQ(count_lost_pixels(front_view(), flat(10), hole, 0.0), 100U);
  EXPECT_EQ(count_lost_pixels(front_view(), flat(10), hole, 2.0), 4U * 4U);  // r = 3 on each side
  EXPECT_EQ(count_lost_pixels(front_view(), flat(10), hole, 4.0), 0U);       // not wider than twice r = 5
  EXPECT_EQ(count_lost_pixels(front_view(), hole, flat(10), 0.0), 0U);       // what is there too much is not lost
}

TEST(CountLostPixels, DepthsAndSilhouettesMayMove) {
  // f = 40 px: at 2 px r = 3, and 3 px at depth 10 are 0.75 units.
  EXPECT_EQ(count_lost_pixels(front_view(), flat(10), flat(10.7), 2.0), 0U);
  EXPECT_EQ(count_lost_pixels(front_view(), flat(10), flat(10.8), 2.0), pixels);
  EXPECT_EQ(count_lost_pixels(front_view(), flat(10), flat(10.001), 0.0), pixels);
  // A strip of the near half is missing: 6 columns are erased from both sides; of 9, three are left.
  EXPECT_EQ(count_lost_pixels(front_view(), step(56), step(50), 2.0), 0U);
  EXPECT_EQ(count_lost_pixels(front_view(), step(59), step(50), 2.0), 3U * 80U);
}

TEST(LargestMotion, OfAShiftedPlaneIsTheShift) {
  // As in ComparePictures: 0.5 units at depth 10 are 2 px. The other way round they are seen from depth 10.5: the
  // larger of both counts.
  EXPECT_NEAR(largest_motion_px(front_view(), flat(10), flat(10.5)), 2.0, 1e-4);
  EXPECT_NEAR(largest_motion_px(front_view(), flat(10.5), flat(10)), 2.0, 1e-4);
  EXPECT_EQ(largest_motion_px(front_view(), flat(10), flat(10)), 0.0);
  EXPECT_EQ(largest_motion_px(front_view(), flat(10), flat(20), 8.0), 8.0);  // 40 px
}

TEST(LargestMotion, OfASilhouetteIsTheDistanceItMoved) {
  // The sides of the step are 40 px apart in depth, so that columns decide.
  EXPECT_EQ(largest_motion_px(front_view(), step(52), step(50)), 2.0);
  EXPECT_EQ(largest_motion_px(front_view(), step(50), step(57)), 7.0);
  // Columns 90 to 94 are explained by depth before distance: seen from depth 10, depth 20 is 40 px away.
  EXPECT_NEAR(largest_motion_px(front_view(), step(50), step(95)), 40.0, 1e-4);
}

TEST(LargestMotion, OfWhatTheOtherImageLacksHasNoEnd) {
  // A hole that is nowhere near: from depth 10 to infinity is all of the focal length, 40 px.
  DepthBuffer hole = flat(10);
  hole.nearness[100 * 40 + 50] = 0.0F;
  EXPECT_NEAR(largest_motion_px(front_view(), hole, flat(10)), 40.0, 1e-4);
  EXPECT_NEAR(largest_motion_px(front_view(), flat(10), hole), 40.0, 1e-4);
  EXPECT_EQ(largest_motion_px(front_view(), flat(10), hole, 16.0), 16.0);
}

TEST(MeasurePopping, TellsMotionDepthAndSilhouette) {
  // 4 px nearer everywhere (1 unit at depth 10, seen from the later), and the upper half of the rows appears.
  DepthBuffer before = flat(9);
  std::fill_n(before.nearness.begin(), pixels / 2, 0.0F);
  const Popping popping = measure_popping(front_view(), before, flat(10));
  EXPECT_NEAR(popping.rms_px, 4.0, 1e-4);
  EXPECT_NEAR(popping.silhouette_mismatch, 50.0, 1e-9);
  EXPECT_NEAR(popping.largest_px, 40.0, 1e-9);  // from or to infinity
}

}  // namespace
}  // namespace occlod
