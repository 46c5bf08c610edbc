// Random bounds against a random occluder, checked by casting rays through pixels on the CPU.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <optional>

#include "gl/support.h"

namespace occlod::gl {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Depths (distance along the axis) of the occluder around each pixel's centre: the rasteriser may move an edge by 1/256
// pixel, so a few rays 1/64 pixel apart give the nearest and farthest that it can have drawn.
struct RayDepth {
  double nearest = infinite;
  double farthest = 0.0;  // infinite where some ray misses
};

class RayImage {
 public:
  RayImage(const View& view, const Soup& occluder, const glm::dmat4& object_to_world) : view_(view) {
    for (const glm::vec3& p : occluder.positions) world_.emplace_back(object_to_world * glm::dvec4(p, 1.0));
    pixels_.resize(static_cast<std::size_t>(view.width()) * static_cast<std::size_t>(view.height()));
    for (int y = 0; y < view.height(); ++y)
      for (int x = 0; x < view.width(); ++x) pixels_[index(x, y)] = depths(occluder, x + 0.5, y + 0.5);
  }
  // GL's pixels: y upwards.
  [[nodiscard]] const RayDepth& at(int x, int y) const { return pixels_[index(x, y)]; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width()) + static_cast<std::size_t>(x);
  }

  [[nodiscard]] RayDepth depths(const Soup& occluder, double x, double y) const {
    RayDepth result;
    constexpr double d = 1.0 / 64.0;
    for (const glm::dvec2 offset :
         {glm::dvec2(0), glm::dvec2(d, d), glm::dvec2(-d, d), glm::dvec2(d, -d), glm::dvec2(-d, -d)}) {
      const double depth = cast(occluder, glm::dvec2(x, y) + offset);
      result.nearest = std::min(result.nearest, depth);
      result.farthest = std::max(result.farthest, depth);
    }
    return result;
  }

  // Moller & Trumbore. The direction advances one unit of depth.
  [[nodiscard]] double cast(const Soup& occluder, const glm::dvec2& pixel) const {
    const double f = view_.focal_length_px();
    const glm::dvec3 direction((pixel.x - view_.width() / 2.0) / f, (pixel.y - view_.height() / 2.0) / f, -1.0);
    double nearest = infinite;
    for (const Triangle& t : occluder.triangles) {
      const glm::dvec3 a = world_[t.x];
      const glm::dvec3 e1 = world_[t.y] - a;
      const glm::dvec3 e2 = world_[t.z] - a;
      const glm::dvec3 p = glm::cross(direction, e2);
      const double det = glm::dot(e1, p);
      if (det == 0.0) continue;
      const glm::dvec3 s = view_.camera().eye - a;
      const double u = glm::dot(s, p) / det;
      const glm::dvec3 q = glm::cross(s, e1);
      const double v = glm::dot(direction, q) / det;
      const double depth = glm::dot(e2, q) / det;
      if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && depth >= view_.camera().near) nearest = std::min(nearest, depth);
    }
    return nearest;
  }

  View view_;
  std::vector<glm::dvec3> world_;
  std::vector<RayDepth> pixels_;
};

struct Verdict {
  bool must_be_visible = false;
  bool must_be_hidden = false;
};

glm::dvec3 to_pixel(const View& view, const glm::dvec3& world) {  // x, y, depth
  const glm::dvec4 clip = view.world_to_clip() * glm::dvec4(world, 1.0);
  return {(clip.x / clip.w + 1.0) * view.width() / 2.0, (clip.y / clip.w + 1.0) * view.height() / 2.0, clip.w};
}

// Visible for certain: some point of the bound is no farther than anything that can have been drawn at the centre of
// its pixel. Hidden for certain: over all pixels near the bound the occluder is nearer than any point of it, with room
// for a proxy that is wider and nearer than it.
Verdict verdict(const View& view, const RayImage& image, const VisibilityQuery& query,
                const glm::dmat4& object_to_world, std::mt19937& random) {
  Verdict result;
  std::vector<glm::dvec3> points;
  points.reserve(300);
  for (int i = 0; i < 300; ++i)
    points.push_back(to_pixel(view, object_to_world * glm::dvec4(random_point(query, random), 1.0)));
  glm::dvec3 low(infinite);
  glm::dvec3 high(-infinite);
  for (const glm::dvec3& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
    const int x = static_cast<int>(std::floor(p.x));
    const int y = static_cast<int>(std::floor(p.y));
    if (x < 0 || y < 0 || x >= view.width() || y >= view.height()) continue;
    if (p.z <= image.at(x, y).nearest) result.must_be_visible = true;
  }
  // Sampling misses up to some tenths of the extent, circumscribing adds a quarter of it in the shape's own axes,
  // growing 2 pixels, a stretch of 2.5 over 0.4 as much again for round shapes.
  const glm::dvec3 room = 0.8 * (high - low) + glm::dvec3(12.0, 12.0, 12.0 / view.focal_length_px() * high.z);
  result.must_be_hidden =
      low.x - room.x < view.width() && high.x + room.x >= 0 && low.y - room.y < view.height() && high.y + room.y >= 0;
  for (int y = std::max(0, static_cast<int>(low.y - room.y)); y < std::min<double>(view.height(), high.y + room.y); ++y)
    for (int x = std::max(0, static_cast<int>(low.x - room.x)); x < std::min<double>(view.width(), high.x + room.x);
         ++x)
      if (image.at(x, y).farthest > low.z - room.z) result.must_be_hidden = false;
  return result;
}

Soup random_occluder(std::mt19937& random) {
  Soup soup;
  const auto point = [&](float size, const glm::vec3& center) {
    return center +
           glm::vec3(uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size) / 2);
  };
  for (int i = 0; i < 16; ++i) {
    const glm::vec3 center = point(0.9F, glm::vec3(0.0F));
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (int k = 0; k < 3; ++k) soup.positions.push_back(point(0.7F, center));
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  if (random() % 2U == 0) soup.add_quad({-3, -3, -0.6F}, {3, -3, -0.6F}, {3, 3, -0.2F}, {-3, 3, -0.8F});
  return soup;
}

class QueryRandom : public testing::TestWithParam<std::tuple<Platform, ProxyShape>> {};
INSTANTIATE_TEST_SUITE_P(Gl, QueryRandom,
                         testing::Combine(testing::Values(Platform::egl, Platform::osmesa),
                                          testing::Values(ProxyShape::sphere, ProxyShape::box, ProxyShape::cylinder)),
                         [](const auto& param) {
                           return platform_label(std::get<0>(param.param)) + "_" +
                                  shape_label(std::get<1>(param.param));
                         });

TEST_P(QueryRandom, NeverHidesWhatARayFindsInFront) {
  std::string context_missing;
  const std::shared_ptr<Context> context = context_or_null(std::get<0>(GetParam()), context_missing);
  if (!context) GTEST_SKIP() << "no context: " << context_missing;
  const auto occlusion = make_query_occlusion(context);
  const View view = test_view();
  std::mt19937 random(29);
  int visible = 0;
  int hidden = 0;
  for (int scene = 0; scene < 24; ++scene) {
    const glm::dmat4 transform = random_linear(random);
    const glm::dmat4 to_object = glm::inverse(transform);
    const Soup world = random_occluder(random);
    Soup soup = world;
    for (glm::vec3& p : soup.positions) p = glm::vec3(to_object * glm::dvec4(p, 1.0));
    const RayImage image(view, soup, transform);
    const std::array<ObjectView, 1> objects{ObjectView(view, transform)};
    occlusion->begin_view(view, objects);
    const std::array<OccluderPart, 1> parts{soup.part()};
    occlusion->draw_occluder(parts);
    for (int i = 0; i < 150; ++i) {
      glm::dvec3 center(uniform(random, -1.3F, 1.3F), uniform(random, -1, 1), uniform(random, -4, 1));
      const float size = std::exp(uniform(random, -9, -1));
      // Every third bound is centred on the occluder itself: it touches it.
      if (i % 3 == 0) center = glm::dvec3(world.positions[random() % world.positions.size()]);
      const VisibilityQuery query =
          random_bound(std::get<1>(GetParam()), glm::vec3(to_object * glm::dvec4(center, 1.0)), size, random);
      const Verdict expected = verdict(view, image, query, transform, random);
      occlusion->submit(query);
      const std::uint32_t answer = occlusion->collect();
      if (expected.must_be_visible) {
        ++visible;
        ASSERT_NE(answer, 0U) << "scene " << scene << " bound " << i;
      } else if (expected.must_be_hidden) {
        ++hidden;
        EXPECT_EQ(answer, 0U) << "scene " << scene << " bound " << i;
      }
    }
  }
  // The test must have tested something: of 3,600 bounds many are in front and many behind.
  EXPECT_GT(visible, 500);
  EXPECT_GT(hidden, 100);
  RecordProperty("visible", visible);
  RecordProperty("hidden", hidden);
}

}  // namespace
}  // namespace occlod::gl
