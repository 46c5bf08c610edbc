#include "priority/fan_visibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

namespace occlod {
namespace {

struct Fan {
  FanCorners corners;
  std::vector<glm::vec3> ring;
  bool closed = true;

  [[nodiscard]] std::uint32_t next(std::uint32_t place) const { return place + 1 == corners.ring_size ? 0 : place + 1; }
};

Fan random_fan(std::uint32_t ring_size, bool closed, std::mt19937& random) {
  std::uniform_real_distribution<float> at(-1.0F, 1.0F);
  const auto point = [&] { return glm::vec3(at(random), at(random), 0.3F * at(random)); };
  Fan fan;
  fan.closed = closed;
  fan.corners.vertex = point();
  fan.corners.ring_size = ring_size;
  fan.corners.inserted = closed ? ring_size : ring_size - 1;
  fan.corners.parent_place = static_cast<std::uint32_t>(random()) % ring_size;
  for (std::uint32_t i = 0; i < ring_size; ++i) {
    fan.ring.push_back(point());
    fan.corners.set(i, fan.ring.back());
  }
  fan.corners.fill_up();
  return fan;
}

// Face by face, as a fan is defined (split_star.h): inserted faces meet in the vertex; each of them that does not have
// the parent has a removed one with the parent in the vertex's place.
SeenFaces look_one_by_one(const Fan& fan, const glm::vec3& eye, bool two_sided) {
  SeenFaces seen;
  const auto look = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 normal = glm::cross(b - a, c - a), to_eye = eye - a;
    const float facing = glm::dot(normal, to_eye);
    if (!two_sided && !(facing > 0.0F)) return;
    ++seen.count;
    seen.whole += glm::length(normal);
    seen.facing += std::abs(facing) / glm::length(to_eye);
  };
  const FanCorners& corners = fan.corners;
  const std::uint32_t u = corners.parent_place;
  for (std::uint32_t i = 0; i < corners.inserted; ++i) look(corners.vertex, fan.ring[i], fan.ring[fan.next(i)]);
  for (std::uint32_t i = 0; i < corners.inserted; ++i)
    if (i != u && fan.next(i) != u) look(fan.ring[u], fan.ring[i], fan.ring[fan.next(i)]);
  return seen;
}

// Vectors do the same operations, and sums have one order: the same bits, of fans that fill less than a vector, of
// some that fill one, and of more.
TEST(FanLook, IsAsFaceByFace) {
  std::mt19937 random(7);
  const glm::vec3 eye(0.4F, -0.7F, 2.5F);
  std::uint32_t seen_faces = 0, all_faces = 0;
  for (std::uint32_t size = 2; size <= SplitStar::most_ring; ++size)
    for (const bool closed : {false, true})
      for (int repeat = 0; repeat < 20; ++repeat) {
        const Fan fan = random_fan(size, closed, random);
        for (const bool two_sided : {false, true}) {
          const SeenFaces seen = fan_visibility(fan.corners, eye, two_sided);
          const SeenFaces expected = look_one_by_one(fan, eye, two_sided);
          ASSERT_EQ(seen.count, expected.count);
          ASSERT_EQ(seen.whole, expected.whole);
          ASSERT_EQ(seen.facing, expected.facing);
          (two_sided ? all_faces : seen_faces) += seen.count;
        }
      }
  EXPECT_GT(seen_faces, all_faces / 4);
  EXPECT_LT(seen_faces, all_faces * 3 / 4);
}

TEST(FanLook, SphereIsAroundAllCorners) {
  std::mt19937 random(8);
  for (std::uint32_t size = 2; size <= SplitStar::most_ring; ++size) {
    const Fan fan = random_fan(size, true, random);
    std::vector<glm::vec3> points = fan.ring;
    points.push_back(fan.corners.vertex);
    const Box box = bounding_box(points);
    const Sphere sphere = sphere_around(fan.corners);
    EXPECT_EQ(sphere.center, 0.5F * box.min + 0.5F * box.max);
    float radius = 0.0F;
    for (const glm::vec3& p : points) radius = std::max(radius, glm::distance(sphere.center, p));
    EXPECT_EQ(sphere.radius, radius);
  }
}

}  // namespace
}  // namespace occlod
