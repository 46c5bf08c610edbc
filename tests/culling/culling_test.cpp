// Every verdict of culling beside exact arithmetic. OCCLOD_CULLING_CASES: how many verdicts instead of 20,000;
// OCCLOD_CULLING_SEED: of the random hierarchies and views instead of 1.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <iostream>
#include <limits>
#include <optional>
#include <vector>

#include "culling/hard_views.h"
#include "occlod/build_hierarchy.h"
#include "occlod/mesh.h"
#include "occlod/view.h"
#include "oracle/culling_oracle.h"
#include "splits/star.h"

namespace occlod {
namespace {

using test::CullingOracle;
using test::HardViews;

std::uint64_t number_from(const char* variable, std::uint64_t otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

struct Counts {
  std::uint64_t cases = 0;  // nodes, each in one view
  std::uint64_t outside = 0, away = 0, scales = 0;
  std::uint64_t wrong_outside = 0, wrong_away = 0, wrong_scales = 0;
};

// The truth about one view: of every vertex the planes that it is outside of, of every split whether any face of its
// subtree reaches into the frustum (is not outside of one plane) and whether any faces the eye.
class Truth {
 public:
  Truth(const Hierarchy& hierarchy, const CullingOracle& oracle)
      : reaches_in_(hierarchy.split_count()), faces_eye_(hierarchy.split_count()) {
    for (const glm::vec3& p : hierarchy.positions()) outside_.push_back(oracle.planes_outside(p));
    const std::span<const glm::vec3> at = hierarchy.positions();
    for (auto s = static_cast<SplitId>(hierarchy.split_count()); s-- > 0;) {  // children before parents
      star_of(hierarchy, s).for_each_face([&](const Triangle& t) {
        if ((outside_[t.x] & outside_[t.y] & outside_[t.z]) == 0) reaches_in_[s] = true;
        if (!faces_eye_[s] && oracle.faces_eye(at[t.x], at[t.y], at[t.z])) faces_eye_[s] = true;
      });
      const SplitId parent = hierarchy.node(s).parent;
      if (parent == no_id) continue;
      if (reaches_in_[s]) reaches_in_[parent] = true;
      if (faces_eye_[s]) faces_eye_[parent] = true;
    }
  }

  [[nodiscard]] bool is_inside(VertexId v) const { return outside_[v] == 0; }
  [[nodiscard]] bool reaches_in(SplitId s) const { return reaches_in_[s]; }
  [[nodiscard]] bool faces_eye(SplitId s) const { return faces_eye_[s]; }

 private:
  std::vector<std::uint32_t> outside_;
  std::vector<bool> reaches_in_;
  std::vector<bool> faces_eye_;
};

// Whether the sphere touches nothing that an orthographic view shows, though no plane of the frustum may tell: the eye
// that stands for its rays does so only for what it shows.
bool is_beyond_all_shown(const Sphere& sphere, const ObjectView& view) {
  const double reach = glm::length(glm::dvec3(view.eye())) * 0x1p-27;
  return view.is_orthographic() && glm::length(glm::dvec3(sphere.center)) - sphere.radius > reach;
}

// Corners of the split's own faces are in its sphere.
void judge_scale(const Hierarchy& hierarchy, SplitId s, const ObjectView& view, const CullingOracle& oracle,
                 const Truth& truth, HardViews& random, Counts& counts) {
  const float scale = view.largest_scale_px(hierarchy.node(s).sphere);
  if (std::isinf(scale)) return;
  star_of(hierarchy, s).for_each_inserted([&](const Triangle& t) {
    for (int k = 0; k < 3; ++k) {
      if (!truth.is_inside(t[k])) continue;
      ++counts.scales;
      if (oracle.moves_more_than(scale, hierarchy.positions()[t[k]], glm::vec3(random.direction())))
        ++counts.wrong_scales;
    }
  });
}

void judge(const Hierarchy& hierarchy, const Camera& camera, const glm::dmat4& transform, HardViews& random,
           Counts& counts) {
  const ObjectView view(View(camera), transform);
  const CullingOracle oracle(camera, transform);
  const Truth truth(hierarchy, oracle);
  for (SplitId s = 0; s < hierarchy.split_count(); ++s) {
    const SplitNode& node = hierarchy.node(s);
    ++counts.cases;
    if (!view.may_be_inside(node.sphere)) {
      ++counts.outside;
      if (truth.reaches_in(s)) ++counts.wrong_outside;
    }
    if (!is_beyond_all_shown(node.sphere, view) && faces_away(node.cone(), node.sphere, view.eye())) {
      ++counts.away;
      if (truth.faces_eye(s)) ++counts.wrong_away;
    }
    if (s % 16 == 0) judge_scale(hierarchy, s, view, oracle, truth, random, counts);
  }
}

// Calls visit(mesh, camera, transform) for random views, six of each mesh, until `done`.
template <typename Done, typename Visit>
void for_hard_views(HardViews& random, const Done& done, const Visit& visit) {
  while (!done()) {
    const TriangleMesh mesh = clean(random.mesh(), {}, "random mesh").mesh;
    for (int i = 0; i < 6; ++i) {
      const glm::dmat4 transform = random.transform();
      visit(mesh, random.camera(mesh, transform), transform);
    }
  }
}

TEST(Culling, OfHierarchiesIsNeverWrong) {
  const std::uint64_t wanted = number_from("OCCLOD_CULLING_CASES", 20'000);
  HardViews random(number_from("OCCLOD_CULLING_SEED", 1));
  Counts counts;
  const auto done = [&] { return counts.cases >= wanted; };
  for_hard_views(random, done, [&](const TriangleMesh& mesh, const Camera& camera, const glm::dmat4& transform) {
    judge(build_hierarchy(mesh), camera, transform, random, counts);
  });
  std::cout << counts.cases << " nodes in views: " << counts.outside << " outside, " << counts.away << " facing away; "
            << counts.scales << " scales\n";
  EXPECT_EQ(counts.wrong_outside, 0U);
  EXPECT_EQ(counts.wrong_away, 0U);
  EXPECT_EQ(counts.wrong_scales, 0U);
  // It culls where it can: a verdict that is always "may be seen" would pass the above.
  EXPECT_GT(counts.outside, counts.cases / 10);
  EXPECT_GT(counts.away, counts.cases / 50);
  EXPECT_GT(counts.scales, counts.cases / 50);
}

// A sphere that touches a plane of the frustum from outside, at a point that is inside.
std::optional<Sphere> touching_sphere(const glm::vec3& vertex, const ObjectView& view, const CullingOracle& oracle,
                                      HardViews& random) {
  const glm::dvec4 plane(view.planes()[random.below(6)]);
  const glm::dvec3 inward(plane);
  glm::vec3 touched = vertex;
  if (random.below(2) == 0) touched -= glm::vec3((glm::dot(inward, glm::dvec3(vertex)) + plane.w) * inward);
  if (!std::isfinite(glm::length(touched)) || oracle.planes_outside(touched) != 0) return std::nullopt;
  const double radius = random.below(2) == 0 ? 0.0 : random.between(0.0, 1.0) * glm::length(glm::dvec3(touched));
  const glm::vec3 center(glm::dvec3(touched) - radius * inward);
  const double distance = glm::distance(glm::dvec3(center), glm::dvec3(touched));
  return Sphere{center, std::nextafter(static_cast<float>(distance), std::numeric_limits<float>::max())};
}

// The cone that has the triangle's normal at that side at which a surface at its first corner is seen first: in the
// plane of the normal and of the direction from the eye, tilted away from the eye.
NormalCone grazing_cone(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& eye, HardViews& random) {
  const glm::dvec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  const glm::dvec3 away = corners[0] - eye;
  const glm::dvec3 in_plane = glm::normalize(away - glm::dot(away, normal) * normal);
  const double tilt = random.between(0.0, 1.57);
  const glm::vec3 axis(std::cos(tilt) * normal + std::sin(tilt) * in_plane);
  return {axis, static_cast<float>(glm::dot(glm::dvec3(axis), normal)) - 1e-7F};
}

// The displacement at `point` that covers most pixels where the transform stretches alike in all directions: across the
// ray from the eye, in the plane of ray and axis; any across parallel rays. Object space.
glm::vec3 widest_displacement(const glm::vec3& point, const Camera& camera, const glm::dmat4& transform) {
  const glm::dvec3 ray = glm::normalize(glm::dvec3(transform * glm::dvec4(point, 1.0)) - camera.eye);
  const glm::dvec3 ahead = glm::normalize(camera.target - camera.eye);
  const glm::dvec3 across =
      camera.orthographic_height ? glm::cross(ahead, camera.up) : ahead - glm::dot(ahead, ray) * ray;
  return glm::vec3(glm::normalize(glm::inverse(glm::dmat3(transform)) * across));
}

// Bounds of hierarchies have some room; these have none.
TEST(Culling, OfBoundsWithoutRoomIsNeverWrong) {
  const std::uint64_t wanted = number_from("OCCLOD_CULLING_CASES", 20'000);
  HardViews random(number_from("OCCLOD_CULLING_SEED", 1));
  std::uint64_t spheres = 0, wrong_spheres = 0, cones = 0, away = 0, wrong_away = 0, scales = 0, wrong_scales = 0;
  const auto done = [&] { return spheres >= wanted && cones >= wanted; };
  for_hard_views(random, done, [&](const TriangleMesh& mesh, const Camera& camera, const glm::dmat4& transform) {
    const ObjectView view(View(camera), transform);
    const CullingOracle oracle(camera, transform);
    for (const Triangle& t : mesh.triangles) {
      const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
      if (const auto sphere = touching_sphere(a, view, oracle, random)) {
        ++spheres;
        if (!view.may_be_inside(*sphere)) ++wrong_spheres;
      }
      const glm::vec3 across = widest_displacement(a, camera, transform);
      if (const float scale = view.largest_scale_px({a, 0.0F});
          std::isfinite(scale) && std::isfinite(glm::length(across)) && oracle.planes_outside(a) == 0) {
        ++scales;
        if (oracle.moves_more_than(scale, a, across)) ++wrong_scales;
      }
      const NormalCone cone = grazing_cone({glm::dvec3(a), glm::dvec3(b), glm::dvec3(c)}, view.eye(), random);
      if (!cone.culls() || is_beyond_all_shown({a, 0.0F}, view)) continue;
      ++cones;
      if (!faces_away(cone, {a, 0.0F}, view.eye())) continue;
      ++away;
      if (oracle.faces_eye(a, b, c)) ++wrong_away;
    }
  });
  std::cout << spheres << " spheres that touch, " << cones << " cones, " << away << " facing away; " << scales
            << " scales\n";
  EXPECT_EQ(wrong_spheres, 0U);
  EXPECT_EQ(wrong_scales, 0U);
  EXPECT_EQ(wrong_away, 0U);
  EXPECT_GT(away, cones / 10);
}

}  // namespace
}  // namespace occlod
