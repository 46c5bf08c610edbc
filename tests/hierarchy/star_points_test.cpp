// Extents of runs of stars must be those that one look at each corner gives, at any scale.
#include "splits/star_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "splits/star_record.h"

namespace occlod {
namespace {

// Stars with rings of 3 to 12 corners, each of `positions` in one ring or a vertex.
struct Stars {
  Stars(int count, float scale) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    for (int i = 0; i < count; ++i) {
      const std::size_t corners = 3 + random() % 10, begin = positions.size();
      std::vector<VertexId> ring(corners);
      for (std::size_t k = 0; k <= corners; ++k)
        positions.push_back(scale * glm::vec3(unit(random), unit(random), 0.1F * unit(random)));
      for (std::size_t k = 0; k < corners; ++k) ring[k] = static_cast<VertexId>(begin + k);
      std::vector<FaceRef> removed;
      for (std::uint32_t slot = 0; slot + 2 < corners; ++slot) removed.push_back({slot, slot});
      std::vector<std::uint32_t> words;
      EXPECT_TRUE(append_fan({ring, 0, removed}, words));
      points.add(SplitStar(words.data(), static_cast<VertexId>(begin + corners)), positions);
      ends.push_back(positions.size());
    }
  }

  std::vector<glm::vec3> positions;
  std::vector<std::size_t> ends;  // of the positions of each star
  StarPoints points;
};

// The corners of stars [first, end) in double precision.
void expect_extents(const Stars& stars, std::size_t first, std::size_t end) {
  const glm::vec3 center = stars.positions[0], axis = glm::normalize(glm::vec3(0.1F, -0.2F, 1.0F));
  double radius = 0.0, beside = 0.0, t_min = 1e300, t_max = -1e300;
  for (std::size_t i = first == 0 ? 0 : stars.ends[first - 1]; i < stars.ends[end - 1]; ++i) {
    const glm::dvec3 offset = glm::dvec3(stars.positions[i]) - glm::dvec3(center);
    const double t = glm::dot(offset, glm::dvec3(axis));
    radius = std::max(radius, glm::length(offset));
    beside = std::max(beside, glm::length(offset - t * glm::dvec3(axis)));
    t_min = std::min(t_min, t);
    t_max = std::max(t_max, t);
  }
  const PointExtents extents = stars.points.extents(first, end, center, axis);
  const double slack = 1e-6 * radius;  // eight units in the last place
  EXPECT_NEAR(extents.radius, radius, slack);
  EXPECT_NEAR(extents.cylinder_radius, beside, slack);
  EXPECT_NEAR(extents.t_min, t_min, slack);
  EXPECT_NEAR(extents.t_max, t_max, slack);
}

// Lengths whose squares are no floats are measured as well.
TEST(StarPoints, ExtentsOfRuns) {
  for (const float scale : {1.0F, 1e-25F, 1e25F}) {
    const Stars stars(40, scale);
    for (std::size_t first = 0; first < 40; ++first)
      for (const std::size_t end : {first + 1, first + 2, std::size_t{40}})
        if (end <= 40) expect_extents(stars, first, end);
  }
}

TEST(StarPoints, ClearLeavesNothing) {
  Stars stars(3, 1.0F);
  stars.points.clear();
  std::vector<std::uint32_t> words;
  ASSERT_TRUE(append_fan({std::vector<VertexId>{0, 1, 2}, 0, std::vector<FaceRef>{{0, 0}}}, words));
  const std::vector<glm::vec3> positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 0.25F}, {0, 0, 0.5F}};
  stars.points.add(SplitStar(words.data(), 3), positions);
  const PointExtents extents = stars.points.extents(0, 1, glm::vec3(0.0F), glm::vec3(0, 0, 1));
  EXPECT_EQ(extents.radius, 1.0F);
  EXPECT_EQ(extents.t_max, 0.5F);
}

}  // namespace
}  // namespace occlod
