#include "traverse/small_scenes.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "occlod/generate.h"

namespace occlod::hlod::test {
namespace {

std::array<Hlod, 2> in_both_groupings(const TriangleMesh& mesh) {
  return {small_hlod(mesh, Grouping::nested), small_hlod(mesh, Grouping::shifted)};
}

}  // namespace

Hlod small_hlod(const TriangleMesh& mesh, Grouping grouping) {
  HlodBuildOptions options;
  options.node_triangles = 64;
  options.grouping = grouping;
  options.borders = grouping == Grouping::nested ? Borders::free : Borders::locked;
  return build_hlod(mesh, options);
}

const Hlod& city(Grouping grouping) {
  static const std::array<Hlod, 2> hlods = in_both_groupings(generate("city", {{"blocks", 5}, {"facade_cells", 5}}));
  return hlods[grouping == Grouping::shifted ? 1 : 0];
}

const Hlod& planet(Grouping grouping) {
  static const std::array<Hlod, 2> hlods = in_both_groupings(generate("rough-planet", {{"level", 5}}));
  return hlods[grouping == Grouping::shifted ? 1 : 0];
}

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
}

Camera random_camera(const Box& box, std::mt19937_64& random) {
  const glm::dvec3 min(box.min), max(box.max), middle = (min + max) / 2.0, half = (max - min) / 2.0;
  const auto inside = [&] {
    return middle + half * glm::dvec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
  };
  Camera camera;
  camera.eye = middle + half * uniform(random, 0.0, 4.0) *
                            glm::dvec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -0.5, 0.5));
  camera.target = inside();
  camera.up = {0.0, 0.0, 1.0};
  camera.width = 160;
  camera.height = 120;
  camera.fov_y_deg = 60.0;
  camera.near = 1e-3 * glm::length(half);
  camera.far = 1e2 * glm::length(half);
  return camera;
}

Camera from_afar(const Hlod& hlod, std::mt19937_64& random) {
  Camera camera = random_camera(hlod.data().box, random);
  const glm::dvec3 min(hlod.data().box.min), max(hlod.data().box.max);
  camera.target = (min + max) / 2.0;
  const double angle = uniform(random, 0.0, 6.28);
  camera.eye = camera.target + glm::length(max - min) * glm::dvec3(std::cos(angle), std::sin(angle), 0.3) * 1.5;
  return camera;
}

Camera walk(const Box& box, int i, int steps) {
  const glm::dvec3 min(box.min), max(box.max), middle = (min + max) / 2.0, half = (max - min) / 2.0;
  const double angle = 6.283185307179586 * i / steps;
  const glm::dvec3 out(std::cos(angle), std::sin(angle), 0.0), along(-out.y, out.x, 0.0);
  std::mt19937_64 random(1);
  Camera camera = random_camera(box, random);
  camera.eye = middle + half * out * 0.5;
  camera.target = camera.eye + half * along;
  return camera;
}

}  // namespace occlod::hlod::test
