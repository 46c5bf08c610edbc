#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <vector>

#include "raster/every_target.h"
#include "refine/refine_support.h"
#include "refine/star_visibility.h"
#include "splits/star.h"

namespace occlod {
namespace {

// A fan of random points: the ring, then the vertex.
struct Fan {
  std::vector<std::uint32_t> record;
  std::vector<glm::vec3> points;

  [[nodiscard]] SplitStar star() const { return {record.data(), static_cast<VertexId>(points.size() - 1)}; }
};

Fan random_fan(std::uint32_t ring_size, bool closed, std::mt19937& random) {
  std::uniform_real_distribution<float> at(-1.0F, 1.0F);
  Fan fan;
  const std::uint32_t parent_place = static_cast<std::uint32_t>(random()) % ring_size;
  fan.record.push_back(ring_size | parent_place << 8U | (closed ? SplitStar::closed_bit : 0U));
  for (std::uint32_t i = 0; i < ring_size; ++i) fan.record.push_back(i);
  for (std::uint32_t i = 0; i <= ring_size; ++i) fan.points.emplace_back(at(random), at(random), 0.3F * at(random));
  return fan;
}

struct Seen {
  float faces = 0.0F, whole = 0.0F, facing = 0.0F;
};

// Face by face, as a fan is defined (split_star.h): inserted faces meet in the vertex; each of them that does not have
// the parent has a removed one with the parent in the vertex's place.
Seen look_one_by_one(const Fan& fan, const glm::vec3& eye, bool two_sided) {
  const SplitStar star = fan.star();
  const auto size = static_cast<std::uint32_t>(star.ring().size());
  const VertexId parent = star.parent_vertex();
  Seen seen;
  float facing_vertex = 0.0F, facing_parent = 0.0F;
  const auto look = [&](VertexId a, VertexId b, VertexId c, float& facing_sum) {
    const glm::vec3 &pa = fan.points[a], &pb = fan.points[b], &pc = fan.points[c];
    const glm::vec3 normal = glm::cross(pb - pa, pc - pa);
    const float facing = glm::dot(normal, eye - pa);
    if (!two_sided && !(facing > 0.0F)) return;
    seen.faces += 1.0F;
    seen.whole += glm::length(normal);
    facing_sum += std::abs(facing);
  };
  for (std::uint32_t i = 0; i < star.inserted_count(); ++i) {
    const VertexId next = i + 1 == size ? 0 : i + 1;
    look(star.vertex(), i, next, facing_vertex);
    if (i != parent && next != parent) look(parent, i, next, facing_parent);
  }
  seen.facing = facing_vertex / glm::length(eye - fan.points[star.vertex()]) +
                facing_parent / glm::length(eye - fan.points[parent]);
  return seen;
}

class FanBatchTest : public ::testing::Test {
 protected:
  FanBatchTest() {
    std::mt19937 random(7);
    for (int repeat = 0; repeat < 6; ++repeat)
      for (std::uint32_t size = 2; size <= SplitStar::max_ring; ++size)
        for (const bool closed : {false, true}) fans_.push_back(random_fan(size, closed, random));
    std::shuffle(fans_.begin(), fans_.end(), random);
  }
  // In batches of `size`; calls check(fan, views, place in these).
  template <typename Check>
  void for_each_view(std::size_t size, bool two_sided, const Check& check) {
    for (std::size_t first = 0; first < fans_.size(); first += size) {
      const std::size_t end = std::min(first + size, fans_.size());
      batch_.clear();
      for (std::size_t i = first; i < end; ++i) batch_.add(fans_[i].star(), fans_[i].points);
      FanViews views;
      find_fan_views(batch_, view_, two_sided, views);
      for (std::size_t i = first; i < end; ++i) check(fans_[i], views, i - first);
    }
  }

  std::vector<Fan> fans_;
  FanBatch batch_;
  ObjectView view_{View(test::front_camera(2.5)), glm::dmat4(1.0)};
};

// Vectors do the same operations, and sums have one order: the same bits, whatever else is in the batch.
TEST_F(FanBatchTest, IsAsFaceByFace) {
  test::for_every_target([&](const char* target) {
    SCOPED_TRACE(target);
    float seen_faces = 0.0F, all_faces = 0.0F;
    for (const std::size_t size : {std::size_t{1}, std::size_t{5}, FanBatch::capacity})
      for (const bool two_sided : {false, true})
        for_each_view(size, two_sided, [&](const Fan& fan, const FanViews& views, std::size_t i) {
          const Seen expected = look_one_by_one(fan, view_.eye(), two_sided);
          ASSERT_EQ(views.faces[i], expected.faces);
          ASSERT_EQ(views.whole[i], expected.whole);
          ASSERT_EQ(views.facing[i], expected.facing);
          (two_sided ? all_faces : seen_faces) += expected.faces;
        });
    EXPECT_GT(seen_faces, all_faces / 4.0F);
    EXPECT_LT(seen_faces, all_faces * 3.0F / 4.0F);
  });
}

TEST_F(FanBatchTest, SphereIsAroundAllCorners) {
  test::for_every_target([&](const char* target) {
    SCOPED_TRACE(target);
    for_each_view(FanBatch::capacity, false, [&](const Fan& fan, const FanViews& views, std::size_t i) {
      const Box box = bounding_box(fan.points);
      const Sphere sphere = views.sphere(i);
      ASSERT_EQ(sphere.center, 0.5F * box.min + 0.5F * box.max);
      float radius = 0.0F;
      for (const glm::vec3& p : fan.points) radius = std::max(radius, glm::distance(sphere.center, p));
      ASSERT_EQ(sphere.radius, radius);
    });
  });
}

TEST_F(FanBatchTest, KnowsHowLargeItIsOnTheScreenAndWhatCrossesTheFrustum) {
  Camera camera = test::front_camera(2.4);
  camera.fov_y_deg = 60.0;
  view_ = ObjectView(View(camera), glm::dmat4(1.0));
  std::size_t inside = 0, crossing = 0;
  test::for_every_target([&](const char* target) {
    SCOPED_TRACE(target);
    for_each_view(FanBatch::capacity, false, [&](const Fan&, const FanViews& views, std::size_t i) {
      const Sphere sphere = views.sphere(i);
      ASSERT_EQ(views.scale_px[i], view_.largest_scale_px(sphere));
      float room = std::numeric_limits<float>::infinity();
      for (const glm::vec4& plane : view_.planes())
        room = std::min(room, glm::dot(glm::vec3(plane), sphere.center) + plane.w - sphere.radius);
      ASSERT_EQ(views.room_inside[i], room);
      ++(room > 0.0F ? inside : crossing);
    });
  });
  EXPECT_GT(inside, 100U);
  EXPECT_GT(crossing, 100U);
}

}  // namespace
}  // namespace occlod
