#include "navigation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "occlod/view.h"

namespace occlod::viewer {
namespace {

Camera some_camera() {
  Camera camera;
  camera.eye = {1.0, 2.0, 5.0};
  camera.target = {0.5, 0.0, 0.0};
  camera.width = 800;
  camera.height = 500;
  return camera;
}

glm::dvec2 place_of(const Camera& camera, const glm::dvec3& point) {
  const glm::dvec4 clip = View(camera).world_to_clip() * glm::dvec4(point, 1.0);
  return {0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w};
}

double elevation_deg(const Camera& camera) {
  return std::asin(glm::normalize(camera.eye - camera.target).y) * 180.0 / std::acos(-1.0);
}

TEST(Navigation, OrbitKeepsTargetAndDistance) {
  Camera camera = some_camera();
  const double distance = glm::length(camera.eye - camera.target);
  orbit(camera, 30.0, -20.0);
  EXPECT_EQ(camera.target, some_camera().target);
  EXPECT_NEAR(glm::length(camera.eye - camera.target), distance, 1e-12);
  EXPECT_GT(glm::length(camera.eye - some_camera().eye), 1.0);  // and it moves
}

TEST(Navigation, OrbitTurnsOnceAroundInFourQuarters) {
  Camera camera = some_camera();
  for (int i = 0; i < 4; ++i) orbit(camera, 90.0, 0.0);
  EXPECT_LT(glm::length(camera.eye - some_camera().eye), 1e-12);
}

// A camera straight above its target has no right direction: every later turn would be undefined.
TEST(Navigation, OrbitStopsBeforeThePole) {
  Camera camera = some_camera();
  for (int i = 0; i < 100; ++i) orbit(camera, 0.0, -10.0);
  EXPECT_NEAR(elevation_deg(camera), 89.0, 1e-6);
  for (int i = 0; i < 100; ++i) orbit(camera, 0.0, 10.0);
  EXPECT_NEAR(elevation_deg(camera), -89.0, 1e-6);
}

TEST(Navigation, LookingAroundKeepsTheEye) {
  Camera camera = some_camera();
  look_around(camera, 45.0, 10.0);
  EXPECT_EQ(camera.eye, some_camera().eye);
  // What is looked at now was to the right of the middle and above it.
  const glm::dvec2 place = place_of(some_camera(), camera.target);
  EXPECT_GT(place.x, 0.5);
  EXPECT_LT(place.y, 0.5);
}

// The point under the cursor at the target's distance is where the ray meets the plane through the target.
TEST(Navigation, ZoomKeepsThePointUnderTheCursor) {
  Camera camera = some_camera();
  const glm::dvec2 cursor(0.8, 0.3);
  const glm::dvec3 ray = ray_through(camera, cursor).direction;
  const glm::dvec3 ahead = glm::normalize(camera.target - camera.eye);
  const glm::dvec3 point = camera.eye + ray * (glm::length(camera.target - camera.eye) / glm::dot(ray, ahead));
  zoom(camera, 0.5, cursor);
  const glm::dvec2 place = place_of(camera, point);
  EXPECT_NEAR(place.x, cursor.x, 1e-9);
  EXPECT_NEAR(place.y, cursor.y, 1e-9);
  EXPECT_NEAR(glm::length(camera.eye - point), 0.5 * glm::length(some_camera().eye - point), 1e-9);
}

// A drag across the whole picture takes what was at one edge to the other.
TEST(Navigation, PanMovesTheTargetAcrossThePicture) {
  Camera camera = some_camera();
  pan(camera, 0.25, 0.1);
  const glm::dvec2 place = place_of(camera, some_camera().target);
  EXPECT_NEAR(place.x, 0.25, 1e-9);
  EXPECT_NEAR(place.y, 0.6, 1e-9);
}

TEST(Navigation, WalkingStaysLevel) {
  Camera camera = some_camera();
  move_level(camera, {1.0, 0.0, 2.0});
  EXPECT_EQ(camera.eye.y, some_camera().eye.y);
  EXPECT_NEAR(glm::length(camera.eye - some_camera().eye), std::sqrt(5.0), 1e-12);
}

// How far inside the planes of the camera the sphere is: left, right, bottom, top, near, far; negative = cut.
std::array<double, 6> room_of(const Camera& camera, const SceneBounds& bounds) {
  const ObjectView object(View(camera), glm::dmat4(1.0));
  std::array<double, 6> room{};
  for (std::size_t i = 0; i < room.size(); ++i) {
    const glm::dvec4 plane(object.planes().at(i));
    room.at(i) = glm::dot(glm::dvec3(plane), bounds.center) + plane.w - bounds.radius;
  }
  return room;
}

// The sphere is on the inner side of all six planes, and nearly touches one at the sides.
TEST(Navigation, FramedSceneIsInsideThePictureAndItsPlanes) {
  const SceneBounds bounds{{3.0, -1.0, 2.0}, 2.5};
  for (const bool parallel : {false, true})
    for (const auto& [width, height] : {std::pair(800, 500), std::pair(300, 900)}) {
      Camera camera = some_camera();
      camera.width = width;
      camera.height = height;
      if (parallel) camera.orthographic_height = 0.1;
      frame(camera, bounds);
      fit_range(camera, bounds);
      const auto room = room_of(camera, bounds);
      EXPECT_GT(*std::min_element(room.begin(), room.end()), -1e-3);
      // Parallel rays show as much at the middle as perspective does, which needs more for what is nearer.
      EXPECT_LT(*std::min_element(room.begin(), room.begin() + 4), parallel ? 0.3 : 0.2);
    }
}

// A wide picture shows a sphere far beside its middle, where the plane through the sphere's near end is nearer to the
// eye than that end is.
TEST(Navigation, PlanesHoldWhatIsAtTheEdge) {
  const SceneBounds bounds{{0.0, 0.0, 0.0}, 1.0};
  Camera camera = some_camera();
  camera.fov_y_deg = 100.0;
  frame(camera, bounds);
  camera.eye -= 5.0 * glm::normalize(camera.target - camera.eye);
  look_around(camera, 50.0, 0.0);
  fit_range(camera, bounds);
  ASSERT_LT(place_of(camera, bounds.center).x, 0.25);
  ASSERT_GT(place_of(camera, bounds.center).x, 0.0);
  EXPECT_GT(room_of(camera, bounds).at(4), 0.0);
  EXPECT_GT(room_of(camera, bounds).at(5), 0.0);
}

Camera orthographic_camera() { return orthographic(some_camera()); }

// Points as far away as the target stay in their places, and the way back leads to the eye.
TEST(Navigation, SwitchingKeepsWhatIsShownAtTheTarget) {
  const SceneBounds bounds{{0.0, 0.0, 0.0}, 20.0};  // around the eye
  Camera camera = some_camera();
  const glm::dvec3 ahead = glm::normalize(camera.target - camera.eye);
  const glm::dvec3 beside = camera.target + glm::normalize(glm::cross(ahead, camera.up));
  const glm::dvec2 place = place_of(camera, beside);
  set_orthographic(camera, true, bounds);
  ASSERT_TRUE(camera.orthographic_height);
  EXPECT_LT(glm::distance(place_of(camera, beside), place), 1e-9);
  EXPECT_LT(glm::distance(place_of(camera, beside - ahead), place), 1e-9);  // and rays are parallel
  EXPECT_GT(room_of(camera, bounds).at(4), 0.0);                            // nothing is behind the eye
  EXPECT_GT(room_of(camera, bounds).at(5), 0.0);
  set_orthographic(camera, false, bounds);
  EXPECT_FALSE(camera.orthographic_height);
  EXPECT_LT(glm::distance(camera.eye, some_camera().eye), 1e-12);
  EXPECT_EQ(camera.target, some_camera().target);
}

// At every depth, not only at the target's.
TEST(Navigation, OrthographicZoomKeepsThePointsUnderTheCursor) {
  Camera camera = orthographic_camera();
  const glm::dvec2 cursor(0.8, 0.3);
  const Ray ray = ray_through(camera, cursor);
  zoom(camera, 0.5, cursor);
  EXPECT_DOUBLE_EQ(*camera.orthographic_height, 0.5 * *orthographic_camera().orthographic_height);
  for (const double depth : {1.0, 4.0, 9.0})
    EXPECT_LT(glm::distance(place_of(camera, ray.origin + depth * ray.direction), cursor), 1e-9);
  // In perspective again it is half as far away.
  set_orthographic(camera, false, {{0.0, 0.0, 0.0}, 1.0});
  EXPECT_NEAR(glm::distance(camera.eye, camera.target), 0.5 * glm::distance(some_camera().eye, some_camera().target),
              1e-9);
}

TEST(Navigation, OrthographicPanMovesEveryDepthAlike) {
  for (const glm::dvec3& point : {glm::dvec3(0.5, 0.0, 0.0), glm::dvec3(0.3, 0.4, 3.0)}) {
    Camera camera = some_camera();
    camera.orthographic_height = 1.7;  // whatever the distance is
    const glm::dvec2 before = place_of(camera, point);
    pan(camera, 0.25, 0.1);
    EXPECT_LT(glm::distance(place_of(camera, point), before + glm::dvec2(-0.25, 0.1)), 1e-9);
  }
}

// The same as in perspective with switching before and after: wherever the eye has had to stand back to, the picture
// does not turn around that.
TEST(Navigation, OrthographicLookingAroundIsThatOfPerspective) {
  const SceneBounds bounds{{0.0, 0.0, 0.0}, 50.0};
  Camera expected = some_camera(), camera = some_camera();
  look_around(expected, 25.0, -10.0);
  set_orthographic(camera, true, bounds);
  look_around(camera, 25.0, -10.0);
  EXPECT_GT(glm::distance(camera.eye, camera.target), 20.0);
  set_orthographic(camera, false, bounds);
  EXPECT_LT(glm::distance(camera.eye, expected.eye), 1e-9);
  EXPECT_LT(glm::distance(camera.target, expected.target), 1e-9);
}

// An orthographic picture is the same from farther back, and whole; planes alone never move the eye.
TEST(Navigation, OrthographicCameraStandsBackFromAll) {
  const SceneBounds bounds{{0.0, 0.0, 4.0}, 3.0};
  Camera camera = orthographic_camera();
  const glm::dvec3 point(0.2, 0.3, 1.0);
  const glm::dvec2 place = place_of(camera, point);
  fit_range(camera, bounds);
  EXPECT_EQ(camera.eye, some_camera().eye);
  EXPECT_LT(room_of(camera, bounds).at(4), 0.0);
  hold(camera, bounds);
  EXPECT_GT(room_of(camera, bounds).at(4), 0.0);
  EXPECT_GT(room_of(camera, bounds).at(5), 0.0);
  EXPECT_LT(glm::distance(place_of(camera, point), place), 1e-9);
  EXPECT_EQ(camera.target, some_camera().target);
  const glm::dvec3 eye = camera.eye;
  hold(camera, bounds);
  EXPECT_LT(glm::distance(camera.eye, eye), 1e-9);
}

TEST(Navigation, SidesLookAlongTheirAxes) {
  const SceneBounds bounds{{1.0, 2.0, 3.0}, 1.0};
  Camera camera = some_camera();
  ASSERT_TRUE(view_from(camera, "right", bounds));
  EXPECT_GT(camera.eye.x, bounds.center.x + 1.0);
  EXPECT_NEAR(camera.eye.y, bounds.center.y, 1e-12);
  ASSERT_TRUE(view_from(camera, "top", bounds));
  EXPECT_GT(camera.eye.y, bounds.center.y + 1.0);
  camera.up = {0.0, 0.0, 1.0};
  ASSERT_TRUE(view_from(camera, "front", bounds));  // against y when z is up
  EXPECT_LT(camera.eye.y, bounds.center.y - 1.0);
  EXPECT_FALSE(view_from(camera, "inside", bounds));
}

}  // namespace
}  // namespace occlod::viewer
