#include "navigation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "occlod/view/view.h"

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
  const glm::dvec3 ray = ray_through(camera, cursor);
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

TEST(Navigation, FramedSceneIsInsideThePictureAndItsPlanes) {
  const SceneBounds bounds{{3.0, -1.0, 2.0}, 2.5};
  for (const auto& [width, height] : {std::pair(800, 500), std::pair(300, 900)}) {
    Camera camera = some_camera();
    camera.width = width;
    camera.height = height;
    frame(camera, bounds);
    fit_range(camera, bounds);
    const View view(camera);
    const ObjectView object(view, glm::dmat4(1.0));
    // The sphere is on the inner side of all six planes, and nearly touches one at the sides.
    double least = 1e9;
    for (const glm::vec4& plane : object.planes()) {
      const double room = glm::dot(glm::dvec3(plane), bounds.center) + static_cast<double>(plane.w) - bounds.radius;
      EXPECT_GT(room, -1e-3);
      least = std::min(least, room);
    }
    EXPECT_LT(least, 0.2);
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
  const ObjectView object(View(camera), glm::dmat4(1.0));
  ASSERT_LT(place_of(camera, bounds.center).x, 0.25);
  ASSERT_GT(place_of(camera, bounds.center).x, 0.0);
  for (const std::size_t plane : {4U, 5U}) {  // near, far
    const glm::dvec4 p(object.planes().at(plane));
    EXPECT_GT(glm::dot(glm::dvec3(p), bounds.center) + p.w, bounds.radius);
  }
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
