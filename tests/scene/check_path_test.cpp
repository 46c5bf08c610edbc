#include "scene/check_path.h"

#include <gtest/gtest.h>

#include <random>

#include "occlod/view.h"

namespace occlod {
namespace {

Camera camera(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up = {0, 1, 0}) {
  Camera result;
  result.eye = eye;
  result.target = target;
  result.up = up;
  return result;
}

int bad_frame(const CameraPath& path) {
  const auto bad = find_bad_frame(path);
  return bad ? bad->frame : -1;
}

// By definition.
int bad_frame_one_by_one(const CameraPath& path) {
  for (int frame = 0; frame < path.frames; ++frame) {
    try {
      const View view(camera_at(path, frame));
    } catch (const Error&) {
      return frame;
    }
  }
  return -1;
}

// From one side of the target to the other: half way the eye is on it. Of an even number of frames none is there.
TEST(CheckPath, FindsTheFrameWhoseEyeIsOnItsTarget) {
  CameraPath path{{camera({0, 0, 5}, {0, 0, 0}), camera({0, 0, -5}, {0, 0, 0})}, 5};
  ASSERT_EQ(bad_frame(path), 2);
  EXPECT_EQ(find_bad_frame(path)->text(), "makes no view in frame 2 of 5, numbered from 0: target is where the eye is");
  path.frames = 4;
  EXPECT_EQ(bad_frame(path), -1);
  path.frames = 5;
  path.jump = true;
  EXPECT_EQ(bad_frame(path), -1);
}

// Half way the camera looks along (0, 1, 0), its up direction.
TEST(CheckPath, FindsTheFrameThatLooksUp) {
  EXPECT_EQ(bad_frame({{camera({0, 0, 0}, {0, 0, -1}), camera({0, 0, 0}, {0, 2, 1})}, 3}), 1);
}

TEST(CheckPath, FindsTheFrameWithoutUp) {
  EXPECT_EQ(bad_frame({{camera({0, 0, 5}, {0, 0, 0}), camera({0, 0, 5}, {0, 0, 0}, {0, -1, 0})}, 3}), 1);
}

// The middle of 2 * 10^9 + 1 frames; asked one by one they would take minutes.
TEST(CheckPath, TimeDoesNotDependOnTheNumberOfFrames) {
  EXPECT_EQ(bad_frame({{camera({0, 0, 5}, {0, 0, 0}), camera({0, 0, -5}, {0, 0, 0})}, 2'000'000'001}), 1'000'000'000);
  EXPECT_EQ(bad_frame({{camera({0, 0, 5}, {0, 0, 0}), camera({1, 0, -5}, {0, 0, 0})}, 2'000'000'001}), -1);
}

// Keys on a lattice meet their targets and up directions often.
TEST(CheckPath, FindsWhatAskingFrameByFrameFinds) {
  std::mt19937 random(5);
  const auto place = [&] {
    const auto coordinate = [&] { return static_cast<double>(random() % 3) - 1.0; };
    return glm::dvec3(coordinate(), coordinate(), coordinate());
  };
  int bad = 0;
  for (int round = 0; round < 20'000; ++round) {
    CameraPath path;
    path.frames = 1 + static_cast<int>(random() % 12);
    const std::size_t keys = 1 + random() % 5;
    while (path.keys.size() < keys) {
      const CameraPath key{{camera(place(), place(), place())}, 1};
      if (bad_frame_one_by_one(key) < 0) path.keys.push_back(key.keys[0]);
    }
    const int expected = bad_frame_one_by_one(path);
    ASSERT_EQ(bad_frame(path), expected) << round;
    bad += expected >= 0;
  }
  EXPECT_GT(bad, 100);
}

}  // namespace
}  // namespace occlod
