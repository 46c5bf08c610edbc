// The geometry of proxies, without OpenGL.
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <map>
#include <numbers>

#include "gl/support.h"
#include "hlod/draw/box_proxy.h"
#include "oracle/random_shapes.h"

namespace occlod::gl {
namespace {

constexpr std::array<ProxyShape, 3> all_shapes{ProxyShape::sphere, ProxyShape::box, ProxyShape::cylinder};

struct Plane {
  glm::dvec3 normal;  // outward, unit
  double offset;
};

std::vector<Plane> planes_of(ProxyShape shape) {
  const ProxyMesh& mesh = unit_proxy(shape);
  std::vector<Plane> planes;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::dvec3 a(mesh.vertices[mesh.indices[i]]);
    const glm::dvec3 b(mesh.vertices[mesh.indices[i + 1]]);
    const glm::dvec3 c(mesh.vertices[mesh.indices[i + 2]]);
    const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    planes.push_back({normal, glm::dot(normal, a)});
  }
  return planes;
}

// The counts of Birkholz & Rahn: 32 triangles for a sphere, 12 for a box, 64 for a cylinder.
TEST(Proxies, HaveThePapersTriangleCounts) {
  EXPECT_EQ(unit_proxy(ProxyShape::sphere).indices.size(), 3U * 32U);
  EXPECT_EQ(unit_proxy(ProxyShape::box).indices.size(), 3U * 12U);
  EXPECT_EQ(unit_proxy(ProxyShape::cylinder).indices.size(), 3U * 64U);
}

// Closed and consistently wound: each directed edge once, its opposite once. Outward and convex: every vertex behind
// every plane.
TEST(Proxies, AreClosedConvexAndWoundOutwards) {
  for (const ProxyShape shape : all_shapes) {
    const ProxyMesh& mesh = unit_proxy(shape);
    std::map<std::pair<int, int>, int> edges;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
      for (std::size_t k = 0; k < 3; ++k) ++edges[{mesh.indices[i + k], mesh.indices[i + (k + 1) % 3]}];
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1) << shape_label(shape);
      EXPECT_EQ(edges.count({edge.second, edge.first}), 1U) << shape_label(shape);
    }
    for (const Plane& plane : planes_of(shape))
      for (const glm::vec3& v : mesh.vertices)
        EXPECT_LE(glm::dot(plane.normal, glm::dvec3(v)), plane.offset + 1e-6) << shape_label(shape);
  }
}

// A plane with unit normal n and offset d leaves the unit ball inside iff d >= 1; the cylinder iff d >= sqrt(nx^2 +
// ny^2) + |nz|; the cube iff d >= |nx| + |ny| + |nz|. Tangent (d not much larger): the proxies are not wider than they
// must be.
TEST(Proxies, AreCircumscribedTightly) {
  for (const ProxyShape shape : all_shapes)
    for (const Plane& plane : planes_of(shape)) {
      const glm::dvec3 n = glm::abs(plane.normal);
      const double support = shape == ProxyShape::sphere ? 1.0
                             : shape == ProxyShape::box  ? n.x + n.y + n.z
                                                         : std::hypot(n.x, n.y) + n.z;
      EXPECT_GE(plane.offset, support) << shape_label(shape);
      EXPECT_LE(plane.offset, support + 2e-6) << shape_label(shape);
    }
}

// The promise on which the backend stands: take any point q of the bound, and the centre of any pixel that q may lie
// in: that is any offset of up to half a diagonal, at the same depth. The proxy must contain that point too, for then
// its front face covers the pixel's centre no farther than q.
TEST(Proxies, ContainThePixelCentresOfEveryPointAtItsOwnDepth) {
  const View view = test_view();
  const Screen screen(view);
  test::RandomShapes random(11);
  for (int kind = 0; kind < test::bound_kinds; ++kind) {
    for (int trial = 0; trial < 200; ++trial) {
      // Centres within the frustum, sizes from sub-pixel to most of the screen, transforms that shear the growth.
      glm::dmat4 transform = random.linear();
      transform[3] = glm::dvec4(random.point(1.0) * glm::dvec3(1.0, 1.0, 2.5) - glm::dvec3(0.0, 0.0, 1.5), 1.0);
      const ObjectView object(view, transform);
      const ProxySpace space(screen, clip_matrix(view.camera(), object), object.mirrored());
      const VisibilityQuery query =
          random.bound(static_cast<test::BoundKind>(kind), glm::vec3(0.0F), std::exp(random.in(-7.0, 0.0)));
      const auto placement = place(query);
      ASSERT_TRUE(placement);
      const Placement proxy = grown(*placement, screen, space);
      const std::vector<Plane> planes = planes_of(proxy.shape);
      const glm::dmat4 clip_to_object = glm::inverse(space.object_to_clip);
      for (int k = 0; k < 50; ++k) {
        const glm::dvec4 clip = space.object_to_clip * glm::dvec4(random.sample(query), 1.0);
        if (clip.w <= 0.0) continue;
        const double angle = random.in(0.0, 2.0 * std::numbers::pi);
        const glm::dvec4 offset(std::cos(angle) * std::sqrt(0.5) * 2.0 / screen.width * clip.w,
                                std::sin(angle) * std::sqrt(0.5) * 2.0 / screen.height * clip.w, 0.0, 0.0);
        const glm::dvec3 moved(clip_to_object * (clip + offset));
        const glm::dvec3 unit = ((moved - proxy.center) * proxy.directions) / proxy.half;
        for (const Plane& plane : planes)
          ASSERT_LE(glm::dot(plane.normal, unit), plane.offset) << shape_label(proxy.shape) << " trial " << trial;
      }
    }
  }
}

// A sphere of radius 0 grows by 0.75 pixels: at depth 3 that is 0.75 pixel_at_wall, whatever the rotation; a scale of s
// divides it in object space.
TEST(Proxies, GrowByThreeQuartersOfAPixel) {
  const View view = test_view();
  for (const double scale : {1.0, 4.0}) {
    const ObjectView object(view,
                            glm::scale(glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(1, 2, 3)), glm::dvec3(scale)));
    const ProxySpace space(Screen(view), clip_matrix(view.camera(), object), object.mirrored());
    const Placement proxy = grown(*place({0, Sphere{{0, 0, 0}, 0.0F}}), Screen(view), space);
    EXPECT_NEAR(proxy.half.x, 0.75 * pixel_at_wall / scale, 1e-6);
  }
}

// 1/100 along z squeezes the world: growth must follow each axis of the box, not the worst of them.
TEST(Proxies, GrowBoxesAlongEachAxisByItsOwnScale) {
  const View view = test_view();
  const ObjectView object(view, glm::scale(glm::dmat4(1.0), glm::dvec3(1.0, 1.0, 0.01)));
  const ProxySpace space(Screen(view), clip_matrix(view.camera(), object), object.mirrored());
  const Placement proxy = grown(*place({0, Box{{-0.1F, -0.1F, 0}, {0.1F, 0.1F, 0}}}), Screen(view), space);
  EXPECT_NEAR(proxy.half.x, 0.1 + 0.75 * pixel_at_wall, 1e-6);
  EXPECT_NEAR(proxy.half.z, 75.0 * pixel_at_wall, 1e-4);
}

class Plan : public testing::Test {
 protected:
  QueryPlan plan(const VisibilityQuery& query) const { return plan_query(screen_, space_, query); }
  // Visible without drawing.
  void expect_trusted(const VisibilityQuery& query) const {
    const QueryPlan p = plan(query);
    EXPECT_FALSE(p.draw);
    EXPECT_TRUE(p.visible);
  }
  View view_ = test_view();
  Screen screen_{view_};
  ProxySpace space_{screen_, clip_matrix(view_.camera(), ObjectView(view_, glm::dmat4(1.0))), false};
};

TEST_F(Plan, NotFiniteOrInsideOutIsVisible) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, inf, -inf}) {
    expect_trusted({0, Sphere{{0, bad, 0}, 0.1F}});
    expect_trusted({0, Sphere{{0, 0, 0}, bad}});
    expect_trusted({0, Box{{bad, 0, 0}, {0.1F, 0.1F, 0.1F}}});
    expect_trusted({0, Box{{0, 0, 0}, {0.1F, bad, 0.1F}}});
    expect_trusted({0, Cylinder{{0, 0, bad}, 0.1F, {0, 0, 1}, 0, 0.1F}});
    expect_trusted({0, Cylinder{{0, 0, 0}, bad, {0, 0, 1}, 0, 0.1F}});
    expect_trusted({0, Cylinder{{0, 0, 0}, 0.1F, {0, bad, 0}, 0, 0.1F}});
    expect_trusted({0, Cylinder{{0, 0, 0}, 0.1F, {0, 0, 1}, bad, 0.1F}});
    // Not the first point: a running minimum would pass over NaN there.
    const std::array<glm::vec3, 3> points{glm::vec3(0.0F), glm::vec3(0.1F, bad, 0.0F), glm::vec3(0.1F)};
    expect_trusted({0, PointHull{points}});
  }
  expect_trusted({0, Cylinder{{0, 0, 0}, 0.1F, {0, 0, 0}, 0, 0.1F}});
  expect_trusted({0, Sphere{{0, 0, 0}, -0.1F}});
  expect_trusted({0, Box{{0.1F, 0, 0}, {-0.1F, 0.1F, 0.1F}}});
  // Finite, but its clip coordinates are not.
  expect_trusted({0, Sphere{{0, 0, 0}, 3e38F}});
}

TEST_F(Plan, AtTheNearPlaneIsVisible) {
  // The near plane is at z = 2.9; a pixel there is 0.1 / 3 of pixel_at_wall, so 0.002 is more than the growth at the
  // back of these bounds.
  expect_trusted({0, Box{{-0.01F, -0.01F, 2.85F}, {0.01F, 0.01F, 2.91F}}});
  expect_trusted({0, Sphere{{0, 0, 3}, 0.01F}});    // the eye inside
  expect_trusted({0, Sphere{{0, 0, 3.5F}, 0.1F}});  // behind the eye
  EXPECT_TRUE(plan({0, Box{{-0.01F, -0.01F, 2.85F}, {0.01F, 0.01F, 2.895F}}}).draw);
  // Growth counts: the bound ends 0.0005 before the near plane, less than 0.75 pixels of a point at depth 0.15.
  expect_trusted({0, Box{{-0.01F, -0.01F, 2.85F}, {0.01F, 0.01F, 2.8995F}}});
}

TEST_F(Plan, LargerThanTheScreenIsVisible) {
  // At z = 0 the screen is 64 x 48 pixels of pixel_at_wall: half 1.657 x 1.243.
  expect_trusted({0, Box{{-1.7F, -1.3F, 0}, {1.7F, 1.3F, 0}}});
  EXPECT_TRUE(plan({0, Box{{-1.7F, -1.0F, 0}, {1.7F, 1.0F, 0}}}).draw);
  EXPECT_TRUE(plan({0, Box{{-1.3F, -1.3F, 0}, {1.3F, 1.3F, 0}}}).draw);
  // Thin, but eight screens wide.
  EXPECT_TRUE(plan({0, Box{{-13.0F, 0, 0}, {13.0F, 0.1F, 0}}}).draw);
  expect_trusted({0, Box{{-13.5F, 0, 0}, {13.5F, 0.1F, 0}}});
}

TEST_F(Plan, OffTheScreenIsHiddenWithoutDrawing) {
  for (const glm::vec3 center :
       {glm::vec3(2, 0, 0), glm::vec3(-2, 0, 0), glm::vec3(0, 1.6F, 0), glm::vec3(0, -1.6F, 0)}) {
    const QueryPlan p = plan({0, Sphere{center, 0.1F}});
    EXPECT_FALSE(p.draw);
    EXPECT_FALSE(p.visible);
  }
  // Its edge is outside by less than the growth: it cannot touch a pixel, but it is drawn.
  EXPECT_TRUE(plan({0, Box{{1.66F, -0.1F, 0}, {1.8F, 0.1F, 0}}}).draw);
}

}  // namespace
}  // namespace occlod::gl
