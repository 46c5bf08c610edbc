// Scenes whose answer is known without measuring, and a machine whose costs are round numbers.
#pragma once

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>
#include <vector>

#include "occlod/auto_refiner.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/refiner.h"
#include "support/meshes.h"

namespace occlod::test {

inline Calibration round_calibration() {
  Calibration calibration{150.0, 600.0, 25.0, 350.0, 30.0, 60.0, 1.0, {}};
  calibration.backends.push_back({"software", 20.0, 0.8, 0.4, 200.0, 200.0});
  return calibration;
}

inline View view_at(const glm::dvec3& eye, const glm::dvec3& target, double fov_y_deg = 45.0) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.up = {0.0, 0.0, 1.0};
  camera.fov_y_deg = fov_y_deg;
  camera.width = 320;
  camera.height = 240;
  camera.near = 0.01;
  camera.far = 50.0;
  return View(camera);
}

// A height field over the unit square with waves too low to hide each other from above.
inline Hierarchy open_ground() {
  TriangleMesh mesh = grid(64, 64);
  for (glm::vec3& p : mesh.positions) p.z = 0.02F * std::sin(20.0F * p.x) * std::cos(17.0F * p.y);
  return build_hierarchy(mesh);
}
inline View above_ground() { return view_at({0.5, 0.49, 1.5}, {0.5, 0.5, 0.0}); }

// Spheres behind a wall, and a rough ball before it, in one mesh. With 128 of them asking pays whatever a small sample
// says.
inline Hierarchy wall_with_spheres(int spheres = 32) {
  TriangleMesh mesh = generate("spheres-behind-wall", {{"spheres", spheres}, {"level", 4}});
  const TriangleMesh ball = generate("rough-planet", {{"level", 5}});
  const auto first = static_cast<VertexId>(mesh.positions.size());
  for (const glm::vec3& p : ball.positions) mesh.positions.push_back(0.3F * p + glm::vec3(1.0F, 0.3F, 0.0F));
  for (const Triangle& t : ball.triangles) mesh.triangles.push_back(t + first);
  return build_hierarchy(mesh);
}
// Before the wall, which covers all spheres.
inline View before_wall() { return view_at({3.0, 0.05, 0.05}, {-1.0, 0.0, 0.0}); }

}  // namespace occlod::test
