// Views from the matrices of other programs, against cameras and against the matrices themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/view.h"

namespace occlod {
namespace {

constexpr int width = 320, height = 200;

class RandomNumbers {
 public:
  double between(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  glm::dvec3 in_cube(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }

 private:
  std::mt19937 random_{7};
};

Camera random_camera(RandomNumbers& random, double reach) {
  Camera camera;
  camera.eye = random.in_cube(reach);
  camera.target = camera.eye + random.in_cube(3.0);
  camera.up = random.in_cube(1.0);
  camera.fov_y_deg = random.between(20.0, 120.0);
  camera.width = width;
  camera.height = height;
  camera.near = random.between(0.01, 1.0);
  camera.far = camera.near * std::exp(random.between(1.0, 10.0));
  return camera;
}

glm::dmat4 looking(const Camera& camera) { return glm::lookAt(camera.eye, camera.target, camera.up); }

// The planes may be swapped, which reverses depth.
glm::dmat4 projection(const Camera& camera, ClipDepth depth) {
  const double aspect = static_cast<double>(camera.width) / camera.height, angle = glm::radians(camera.fov_y_deg);
  const double near = depth == ClipDepth::one_to_zero ? camera.far : camera.near;
  const double far = depth == ClipDepth::one_to_zero ? camera.near : camera.far;
  const bool is_gl = depth == ClipDepth::minus_one_to_one;
  if (!camera.orthographic_height)
    return is_gl ? glm::perspectiveRH_NO(angle, aspect, near, far) : glm::perspectiveRH_ZO(angle, aspect, near, far);
  const double y = *camera.orthographic_height / 2.0, x = y * aspect;
  return is_gl ? glm::orthoRH_NO(-x, x, -y, y, near, far) : glm::orthoRH_ZO(-x, x, -y, y, near, far);
}

constexpr ClipDepth all_depths[] = {ClipDepth::minus_one_to_one, ClipDepth::zero_to_one, ClipDepth::one_to_zero};

// The matrices of a camera make the camera's view, up to the rounding of the matrices: eyes are off by that of a
// product with the translation, and planes by that of a difference of depths that are nearly equal.
TEST(ViewOf, TheMatricesOfACameraMakeItsView) {
  RandomNumbers random;
  for (int n = 0; n < 3000; ++n) {
    const double reach = std::pow(10.0, n % 6 - 1);
    Camera camera = random_camera(random, reach);
    if (n % 3 == 0) camera.orthographic_height = random.between(0.1, 10.0);
    const View expected(camera);
    for (const ClipDepth depth : all_depths) {
      const View view = view_of(looking(camera), projection(camera, depth), width, height, depth);
      EXPECT_EQ(view.is_orthographic(), expected.is_orthographic());
      EXPECT_EQ(glm::ivec2(view.width(), view.height()), glm::ivec2(width, height));
      EXPECT_LT(glm::distance(view.camera().eye, camera.eye), 1e-14 * reach);
      EXPECT_LT(glm::distance(view.direction(), expected.direction()), 1e-14);
      EXPECT_NEAR(view.focal_length_px() / expected.focal_length_px(), 1.0, 1e-15 * 8);
      EXPECT_NEAR(view.cos_corner_angle(), expected.cos_corner_angle(), 1e-15);
      EXPECT_EQ(view.camera().principal_point, glm::dvec2(0.0));
      EXPECT_NEAR(view.camera().near / camera.near, 1.0, 1e-15 * camera.far / camera.near);
      EXPECT_NEAR(view.camera().far / camera.far, 1.0, 1e-15 * camera.far / camera.near);
      for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) {
          const double largest = 1.0 + std::abs(expected.world_to_clip()[column][row]);
          const double rounding = 1e-13 * (column == 3 ? 1.0 + reach : 1.0) * view.focal_length_px();
          EXPECT_NEAR(view.world_to_clip()[column][row], expected.world_to_clip()[column][row], rounding * largest);
        }
    }
  }
}

// A program's matrices, and what it makes of its clip space.
struct Program {
  glm::dmat4 world_to_eye, eye_to_clip;
  ClipDepth depth;
  bool is_upside_down = false;  // its image, for us

  [[nodiscard]] View view() const { return view_of(world_to_eye, eye_to_clip, width, height, depth); }
  [[nodiscard]] glm::dvec4 to_clip(const glm::dvec3& p) const {
    return eye_to_clip * (world_to_eye * glm::dvec4(p, 1.0));
  }
};

// By how much a point is inside, in units of w; < 0: outside.
double inside_by(const glm::dvec4& clip, double least_z) {
  if (clip.w <= 0.0) return -1.0;
  return 1.0 - std::max({std::abs(clip.x / clip.w), std::abs(clip.y / clip.w), clip.z / clip.w,
                         1.0 - clip.z / clip.w + least_z});
}

// Every point is inside both, at the same place of the image, or outside both; and the bound on the scale holds.
void expect_the_same_points(const Program& program, RandomNumbers& random) {
  const View view = program.view();
  const ObjectView object(view, glm::dmat4(1.0));
  const double least_z = program.depth == ClipDepth::minus_one_to_one ? -1.0 : 0.0;
  int inside = 0;
  for (int n = 0; n < 2000; ++n) {
    const glm::dvec3 p = random.in_cube(8.0);
    const glm::dvec4 theirs = program.to_clip(p), ours = view.world_to_clip() * glm::dvec4(p, 1.0);
    const double by = inside_by(theirs, least_z);
    if (std::abs(by) < 1e-4) continue;  // on the border, but for rounding
    double least = std::numeric_limits<double>::infinity();
    for (const glm::vec4& plane : object.planes())
      least = std::min(least, glm::dot(glm::dvec4(plane), glm::dvec4(p, 1)));
    EXPECT_EQ(least > 0.0, by > 0.0) << least << ' ' << by;
    EXPECT_EQ(inside_by(ours, -1.0) > 0.0, by > 0.0);
    if (by < 0.0) continue;
    ++inside;
    EXPECT_TRUE(object.may_be_inside({glm::vec3(p), 0.0F}));
    const glm::dvec2 image = glm::dvec2(theirs) / theirs.w, down = glm::dvec2(1, program.is_upside_down ? -1 : 1);
    EXPECT_LT(glm::distance(glm::dvec2(ours) / ours.w, image * down), 1e-9);
    // Finite differences, in pixels a unit, of a point in the frustum.
    const double step = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 moved = p;
      moved[axis] += step;
      const glm::dvec4 there = program.to_clip(moved);
      const glm::dvec2 px = (glm::dvec2(there) / there.w - image) * glm::dvec2(width, height) / 2.0;
      EXPECT_LT(glm::length(px) / step, 1.001 * object.largest_scale_px({glm::vec3(p), 1e-4F}));
    }
  }
  EXPECT_GT(inside, 20);
}

glm::dmat4 random_rotation(RandomNumbers& random) {
  return glm::rotate(glm::dmat4(1.0), random.between(0.0, 6.28), random.in_cube(1.0));
}

// Frusta that contain the line of sight in the middle, at the border or not at all, in every convention.
TEST(ViewOf, OffCentreFrustaShowWhatTheirMatricesShow) {
  RandomNumbers random;
  for (int n = 0; n < 120; ++n) {
    Program program{random_rotation(random), glm::dmat4(1.0), all_depths[n % 3]};
    program.world_to_eye[3] = glm::dvec4(random.in_cube(2.0) + glm::dvec3(0, 0, -3), 1.0);
    const double size = random.between(0.5, 2.0) / height;  // of a pixel at distance 1
    const double left = random.between(-1.5, 0.5), bottom = random.between(-1.5, 0.5);
    const double right = left + size * width, top = bottom + size * height;
    const bool is_gl = program.depth == ClipDepth::minus_one_to_one;
    double near = 0.5, far = 9.0;
    if (program.depth == ClipDepth::one_to_zero) std::swap(near, far);
    const bool is_perspective = n % 2 == 0;
    const auto make = is_perspective ? (is_gl ? glm::frustumRH_NO<double> : glm::frustumRH_ZO<double>)
                                     : (is_gl ? glm::orthoRH_NO<double> : glm::orthoRH_ZO<double>);
    const double scale = is_perspective ? near : 4.0;  // GLM takes borders at the first plane
    program.eye_to_clip = make(left * scale, right * scale, bottom * scale, top * scale, near, far);
    if (n % 5 == 0) {  // y down, as in Vulkan
      for (int column = 0; column < 4; ++column) program.eye_to_clip[column].y *= -1.0;
      program.is_upside_down = true;
    }
    if (n % 7 == 0) program.eye_to_clip *= 0.25;  // clip space is homogeneous
    expect_the_same_points(program, random);
  }
}

// Direct3D: all of its world is left-handed, which ours cannot tell from a mirrored image.
TEST(ViewOf, LeftHandedProgramsShowTheSame) {
  RandomNumbers random;
  const double aspect = static_cast<double>(width) / height;
  for (int n = 0; n < 20; ++n) {
    const glm::dvec3 eye = random.in_cube(4.0);
    const glm::dmat4 looking = glm::lookAtLH(eye, random.in_cube(1.0), glm::dvec3(0, 1, 0));
    expect_the_same_points({looking, glm::perspectiveLH_ZO(1.0, aspect, 0.1, 20.0), ClipDepth::zero_to_one, true},
                           random);
    expect_the_same_points({looking, glm::orthoLH_ZO(-3.2, 3.2, -2.0, 2.0, 0.1, 20.0), ClipDepth::zero_to_one, true},
                           random);
  }
}

// Infinite, reversed and infinite, and with room for rounding.
TEST(ViewOf, NoFarPlane) {
  const double aspect = static_cast<double>(width) / height;
  const glm::dmat4 of_gl = glm::infinitePerspective(1.0, aspect, 0.1);
  glm::dmat4 of_vulkan = of_gl, reversed = of_gl;
  of_vulkan[3].z = -0.1;
  reversed[2].z = 0.0;
  reversed[3].z = 0.1;
  const struct {
    glm::dmat4 eye_to_clip;
    ClipDepth depth;
  } programs[] = {{of_gl, ClipDepth::minus_one_to_one},
                  {glm::tweakedInfinitePerspective(1.0, aspect, 0.1, 0x1p-22), ClipDepth::minus_one_to_one},
                  {of_vulkan, ClipDepth::zero_to_one},
                  {reversed, ClipDepth::one_to_zero}};
  for (const auto& [eye_to_clip, depth] : programs) {
    const View view = view_of(glm::dmat4(1.0), eye_to_clip, width, height, depth);
    EXPECT_NEAR(view.camera().near, 0.1, 1e-7);
    EXPECT_EQ(view.camera().far, infinite_far_ratio * view.camera().near);
    const ObjectView object(view, glm::dmat4(1.0));
    for (float distance = 0.11F; distance < 1e10F; distance *= 3.0F)
      EXPECT_TRUE(object.may_be_inside({{0.0F, 0.3F * distance, -distance}, 0.0F})) << distance;
    EXPECT_FALSE(object.may_be_inside({{0.0F, 0.0F, 1.0F}, 0.0F}));
    EXPECT_FALSE(object.may_be_inside({{0.0F, 6.0F, -10.0F}, 0.0F}));  // tan(0.5) is 0.546
  }
}

// An orthographic near plane may be behind the eye.
TEST(ViewOf, OrthographicPlanesBehindTheEye) {
  RandomNumbers random;
  const Program program{random_rotation(random), glm::orthoRH_NO(-8.0, 8.0, -5.0, 5.0, -6.0, 3.0),
                        ClipDepth::minus_one_to_one};
  EXPECT_GT(program.view().camera().near, 0.0);
  EXPECT_NEAR(program.view().camera().far - program.view().camera().near, 9.0, 1e-12);
  expect_the_same_points(program, random);
}

// Single-precision matrices are rigid up to their rounding.
TEST(ViewOf, MatricesMayBeSinglePrecision) {
  RandomNumbers random;
  for (int n = 0; n < 100; ++n) {
    const Camera camera = random_camera(random, 10.0);
    const glm::dmat4 to_eye(glm::mat4(looking(camera))), to_clip(glm::mat4(projection(camera, ClipDepth::zero_to_one)));
    const View view = view_of(to_eye, to_clip, width, height, ClipDepth::zero_to_one);
    EXPECT_LT(glm::distance(view.camera().eye, camera.eye), 1e-5);
    EXPECT_LT(glm::distance(view.direction(), View(camera).direction()), 1e-6);
  }
}

TEST(ViewOf, RefusesWhatIsNoView) {
  const glm::dmat4 eye = glm::translate(glm::dmat4(1.0), {0.0, 0.0, -3.0});
  const glm::dmat4 lens = glm::perspectiveRH_NO(1.0, static_cast<double>(width) / height, 0.1, 10.0);
  const auto refusal = [&](const std::function<void(glm::dmat4&, glm::dmat4&)>& change, int w = width,
                           ClipDepth depth = ClipDepth::minus_one_to_one) -> std::string {
    glm::dmat4 a = eye, b = lens;
    change(a, b);
    try {
      static_cast<void>(view_of(a, b, w, height, depth));
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  const auto nothing = [](glm::dmat4&, glm::dmat4&) {};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(nothing), "no error");
  EXPECT_NE(refusal([](auto& a, auto&) { a *= 2.0; }).find("world_to_eye: is no rigid motion"), std::string::npos);
  EXPECT_NE(refusal([](auto& a, auto&) { a[1].y = 1.01; }).find("world_to_eye: is no rigid"), std::string::npos);
  EXPECT_NE(refusal([&](auto& a, auto&) { a[3].x = nan; }).find("world_to_eye: is no rigid"), std::string::npos);
  EXPECT_NE(refusal([&](auto&, auto& b) { b[3].z = nan; }).find("eye_to_clip: is not finite"), std::string::npos);
  EXPECT_NE(refusal([](auto&, auto& b) { b[0].w = 0.1; }).find("last row"), std::string::npos);
  EXPECT_NE(refusal([](auto&, auto& b) { b[2].w = 0.0; }).find("last row"), std::string::npos);
  EXPECT_NE(refusal([](auto&, auto& b) { b[1].x = 0.1; }).find("turns, shears or flattens"), std::string::npos);
  EXPECT_NE(refusal([](auto&, auto& b) { b[0].x = 0.0; }).find("turns, shears or flattens"), std::string::npos);
  EXPECT_NE(refusal([](auto&, auto& b) { b[3].x = 0.1; }).find("turns, shears or flattens"), std::string::npos);
  EXPECT_NE(refusal([](auto&, auto& b) { b[0].z = 0.1; }).find("oblique near plane"), std::string::npos);
  EXPECT_NE(refusal([](auto&, auto& b) { b[3].z = 0.0; }).find("no near plane"), std::string::npos);
  EXPECT_NE(refusal(nothing, width, ClipDepth::one_to_zero).find("name the ClipDepth"), std::string::npos);
  EXPECT_NE(refusal(nothing, width + 1).find("pixels that are not square"), std::string::npos);
  EXPECT_NE(refusal(nothing, 0).find("size: is not between"), std::string::npos);
}

// The image of a camera with a principal point is a part of a larger one, and its corner is farthest from the line of
// sight.
TEST(PrincipalPoint, ShowsAPartOfALargerImage) {
  Camera whole;
  whole.width = 2 * width;
  whole.height = 2 * height;
  Camera part = whole;  // the upper right quarter: the line of sight meets its lower left corner
  part.width = width;
  part.height = height;
  part.fov_y_deg = glm::degrees(2.0 * std::atan(std::tan(glm::radians(whole.fov_y_deg) / 2.0) / 2.0));
  part.principal_point = {-1.0, -1.0};
  EXPECT_NEAR(View(part).cos_corner_angle(), View(whole).cos_corner_angle(), 1e-15);
  EXPECT_NEAR(View(part).focal_length_px(), View(whole).focal_length_px(), 1e-10);
  RandomNumbers random;
  for (int n = 0; n < 100; ++n) {
    const glm::dvec4 p(random.in_cube(1.0), 1.0);
    const glm::dvec4 in_part = View(part).world_to_clip() * p, in_whole = View(whole).world_to_clip() * p;
    const glm::dvec2 a = glm::dvec2(in_part) / in_part.w, b = glm::dvec2(in_whole) / in_whole.w;
    EXPECT_LT(glm::distance((a + 1.0) / 2.0, b), 1e-12);
  }
  // Parallel rays show as much at the target.
  const Camera flat = orthographic(part);
  const glm::dvec4 at_target(0.2, 0.1, 0.0, 1.0);
  const glm::dvec4 in_part = View(part).world_to_clip() * at_target;
  EXPECT_LT(glm::distance(glm::dvec2(View(flat).world_to_clip() * at_target), glm::dvec2(in_part) / in_part.w), 1e-12);
  part.orthographic_height = 1.0;
  EXPECT_THROW(View{part}, Error);
  part.orthographic_height.reset();
  part.principal_point.y = std::numeric_limits<double>::infinity();
  EXPECT_THROW(View{part}, Error);
}

}  // namespace
}  // namespace occlod
