// Extents of nodes whose patches are looked at together must be those that one look at each patch gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <vector>

#include "splits/star_patch.h"

namespace occlod {
namespace {

std::vector<Patch> random_patches(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  std::vector<Patch> patches(count);
  for (Patch& patch : patches) {
    patch.sphere = {{unit(random), unit(random), unit(random)}, 0.1F + 0.05F * unit(random)};
    patch.axis = glm::normalize(glm::vec3(0.3F * unit(random), 0.3F * unit(random), 1.0F));
    patch.sin_angle = 0.3F + 0.2F * unit(random);
    patch.cos_angle = std::sqrt(1.0F - patch.sin_angle * patch.sin_angle);
    patch.has_normal = random() % 5 != 0;
  }
  return patches;
}

struct Extent {
  float radius = 0.0F, cylinder_radius = 0.0F;
  float t_min = std::numeric_limits<float>::max(), t_max = std::numeric_limits<float>::lowest();
  float cos_angle = 1.0F;
  bool has_normal = false;

  void include(const Patch& patch, const glm::vec3& center, const glm::vec3& axis) {
    const glm::vec3 offset = patch.sphere.center - center;
    const float along = glm::dot(offset, axis), r = patch.sphere.radius;
    radius = std::max(radius, length_of(offset) + r);
    cylinder_radius = std::max(cylinder_radius, length_of(offset - along * axis) + r);
    t_min = std::min(t_min, along - r);
    t_max = std::max(t_max, along + r);
    if (!patch.has_normal) return;
    has_normal = true;
    cos_angle = std::min(cos_angle, widened(axis, patch));
  }
};

class PatchRowsTest : public testing::Test {
 protected:
  static constexpr std::size_t count = 100;

  PatchRowsTest() {
    for (std::size_t i = 0; i < count; ++i) rows_.set(i, patches_[i]);
  }
  [[nodiscard]] glm::vec3 center(std::size_t i) const { return patches_[i].sphere.center; }
  void expect_extent(const NodeExtents& nodes, std::size_t node, std::size_t first, std::size_t end) const {
    Extent expected;
    for (std::size_t i = first; i < end; ++i) expected.include(patches_[i], center(first), axis_);
    EXPECT_EQ(nodes.radius[node], expected.radius);
    EXPECT_EQ(nodes.cylinder_radius[node], expected.cylinder_radius);
    EXPECT_EQ(nodes.t_min[node], expected.t_min);
    EXPECT_EQ(nodes.t_max[node], expected.t_max);
    EXPECT_EQ(nodes.cos_angle[node], expected.cos_angle);
    EXPECT_EQ(nodes.has_normal[node] != 0, expected.has_normal);
  }

  std::mt19937 random_{9};
  std::vector<Patch> patches_ = random_patches(count, random_);
  PatchRows rows_{count};
  glm::vec3 axis_ = glm::normalize(glm::vec3(0.1F, -0.2F, 1.0F));
};

TEST_F(PatchRowsTest, PatchesComeBack) {
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(rows_[i].sphere.center, patches_[i].sphere.center);
    EXPECT_EQ(rows_[i].axis, patches_[i].axis);
    EXPECT_EQ(rows_[i].has_normal, patches_[i].has_normal);
  }
}

TEST_F(PatchRowsTest, SmallNodesSideBySide) {
  NodeExtents nodes;
  nodes.size.fill(0);
  constexpr std::size_t first = count - NodeExtents::capacity;  // the last nodes reach into the padding
  for (std::size_t i = 0; i < NodeExtents::capacity; ++i) {
    nodes.start(i, center(first + i), axis_);
    nodes.size[i] = static_cast<std::int32_t>(std::min(random_() % NodeExtents::capacity, count - first - i));
  }
  include_patches(rows_, first, nodes);
  for (std::size_t i = 0; i < NodeExtents::capacity; ++i)
    expect_extent(nodes, i, first + i, first + i + static_cast<std::size_t>(nodes.size[i]));
}

TEST_F(PatchRowsTest, ALargeNodeInRuns) {
  NodeExtents nodes;
  nodes.size.fill(0);
  constexpr std::size_t node = 3;
  nodes.start(node, center(7), axis_);
  include_patches(rows_, 7, nodes);  // of empty nodes: where runs begin
  include_run(rows_, 7, 50, nodes, node);
  include_run(rows_, 50, 51, nodes, node);
  expect_extent(nodes, node, 7, 51);
}

TEST_F(PatchRowsTest, TinyLengthsAreTold) {
  // The square of this offset has no place among floats.
  patches_[1].sphere.center = patches_[0].sphere.center = glm::vec3(0.0F);
  patches_[1].sphere.center.x = 1e-25F;
  for (std::size_t i = 0; i < 2; ++i) rows_.set(i, patches_[i]);
  NodeExtents nodes;
  nodes.size.fill(0);
  for (std::size_t i = 0; i < NodeExtents::capacity; ++i) nodes.start(i, glm::vec3(0.0F), axis_);
  nodes.size[0] = 1;
  include_patches(rows_, 0, nodes);
  EXPECT_EQ(nodes.is_extreme[0], 0);
  nodes.size[0] = 2;
  include_patches(rows_, 0, nodes);
  EXPECT_NE(nodes.is_extreme[0], 0);
}

}  // namespace
}  // namespace occlod
