// Cones of nodes whose patches are looked at together must be those that one look at each patch gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "splits/star_patch.h"

namespace occlod {
namespace {

std::vector<Patch> random_patches(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  std::vector<Patch> patches(count);
  for (Patch& patch : patches) {
    patch.axis = glm::normalize(glm::vec3(0.3F * unit(random), 0.3F * unit(random), 1.0F));
    patch.sin_angle = 0.3F + 0.2F * unit(random);
    patch.cos_angle = std::sqrt(1.0F - patch.sin_angle * patch.sin_angle);
    patch.has_normal = random() % 5 != 0;
  }
  return patches;
}

struct Extent {
  float cos_angle = 1.0F;
  bool has_normal = false;

  void include(const Patch& patch, const glm::vec3& axis) {
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
  void expect_extent(const NodeExtents& nodes, std::size_t node, std::size_t first, std::size_t end) const {
    Extent expected;
    for (std::size_t i = first; i < end; ++i) expected.include(patches_[i], axis_);
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
    EXPECT_EQ(rows_[i].axis, patches_[i].axis);
    EXPECT_EQ(rows_[i].has_normal, patches_[i].has_normal);
  }
}

TEST_F(PatchRowsTest, SmallNodesSideBySide) {
  NodeExtents nodes;
  nodes.size.fill(0);
  constexpr std::size_t first = count - NodeExtents::capacity;  // the last nodes reach into the padding
  for (std::size_t i = 0; i < NodeExtents::capacity; ++i) {
    nodes.start(i, axis_);
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
  nodes.start(node, axis_);
  include_patches(rows_, 7, nodes);  // of empty nodes: where runs begin
  include_run(rows_, 7, 50, nodes, node);
  include_run(rows_, 50, 51, nodes, node);
  expect_extent(nodes, node, 7, 51);
}

}  // namespace
}  // namespace occlod
