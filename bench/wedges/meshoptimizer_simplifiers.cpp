#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "stopwatch.h"
#include "wedges/simplifiers.h"

namespace occlod::bench {
namespace {

// As programs that draw have it: one vertex for each wedge.
struct Input {
  explicit Input(const TriangleMesh& textured) : mesh(textured), materials(mesh.wedge_count(), 0) {
    indices.reserve(3 * mesh.triangle_count());
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      for (int i = 0; i < 3; ++i) {
        indices.push_back(mesh.wedge_triangles()[t][i]);
        materials[indices.back()] = mesh.material_of(t);
      }
  }

  [[nodiscard]] WedgeRun output(const std::vector<unsigned>& left, double milliseconds) const {
    WedgeRun run;
    run.milliseconds = milliseconds;
    run.result.positions = mesh.positions;
    run.result.texture_coordinates = mesh.texture_coordinates;
    run.result.materials = mesh.materials;
    run.result.textures = mesh.textures;
    run.result.texture_origin = mesh.texture_origin;
    for (std::size_t i = 0; i < left.size(); i += 3) {
      run.result.triangles.emplace_back(left[i], left[i + 1], left[i + 2]);
      if (!mesh.triangle_materials.empty()) run.result.triangle_materials.push_back(materials[left[i]]);
    }
    return run;
  }

  const TriangleMesh& mesh;
  std::vector<unsigned> indices;
  std::vector<MaterialId> materials;  // by wedge
};

template <typename Call>
std::vector<WedgeRun> simplify(const Input& input, std::span<const std::size_t> targets, const Call& call) {
  std::vector<WedgeRun> runs;
  for (const std::size_t target : targets) {
    std::vector<unsigned> left(input.indices.size());
    const tool::Stopwatch stopwatch;
    left.resize(call(left.data(), 3 * target));
    runs.push_back(input.output(left, stopwatch.milliseconds()));
  }
  return runs;
}

std::vector<WedgeRun> by_geometry(const TriangleMesh& mesh, std::span<const std::size_t> targets) {
  const Input input(mesh);
  return simplify(input, targets, [&](unsigned* left, std::size_t indices) {
    return meshopt_simplify(left, input.indices.data(), input.indices.size(), &mesh.positions[0].x, mesh.wedge_count(),
                            sizeof(glm::vec3), indices, std::numeric_limits<float>::max(), 0, nullptr);
  });
}

#if MESHOPTIMIZER_VERSION >= 200

constexpr float texture_weights[] = {0.3F, 1.0F, 3.0F, 10.0F, 30.0F};  // of which the tables take the best

// Of the largest side of the box, which is what the library measures positions in: one unit of the texture, by the
// root of the area in space over that in the texture.
float texture_scale(const TriangleMesh& mesh) {
  double area = 0.0, texture_area = 0.0;
  for (const Triangle& t : mesh.wedge_triangles()) {
    const glm::dvec3 a(mesh.positions[t.x]), u = glm::dvec3(mesh.positions[t.y]) - a,
                                             v = glm::dvec3(mesh.positions[t.z]) - a;
    const glm::dvec2 b(mesh.texture_coordinates[t.x]), s = glm::dvec2(mesh.texture_coordinates[t.y]) - b,
                                                       r = glm::dvec2(mesh.texture_coordinates[t.z]) - b;
    area += glm::length(glm::cross(u, v));
    texture_area += std::abs(s.x * r.y - s.y * r.x);
  }
  glm::vec3 low = mesh.positions[0], high = low;
  for (const glm::vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
  const glm::vec3 size = high - low;
  const double scale = std::sqrt(area / std::max(texture_area, 1e-30));
  return static_cast<float>(scale / std::max({size.x, size.y, size.z}));
}

std::vector<WedgeRun> with_attributes(const TriangleMesh& mesh, std::span<const std::size_t> targets, float weight,
                                      unsigned options) {
  const Input input(mesh);
  const float scaled = weight * texture_scale(mesh);
  const float weights[] = {scaled, scaled};
  return simplify(input, targets, [&](unsigned* left, std::size_t indices) {
    return meshopt_simplifyWithAttributes(left, input.indices.data(), input.indices.size(), &mesh.positions[0].x,
                                          mesh.wedge_count(), sizeof(glm::vec3), &mesh.texture_coordinates[0].x,
                                          sizeof(glm::vec2), weights, 2, nullptr, indices,
                                          std::numeric_limits<float>::max(), options, nullptr);
  });
}

#endif

}  // namespace

std::string meshoptimizer_version() {
  return fmt::format("{}.{}", MESHOPTIMIZER_VERSION / 1000, MESHOPTIMIZER_VERSION / 10 % 100);
}

std::vector<WedgeSimplifier> meshoptimizer_simplifiers() {
  std::vector<WedgeSimplifier> result = {{"meshopt_simplify", "", by_geometry}};
#if MESHOPTIMIZER_VERSION >= 200
  const auto add = [&](const char* tool, float weight, unsigned options) {
    result.push_back(
        {tool, fmt::format("{}", weight), [=](const TriangleMesh& mesh, std::span<const std::size_t> targets) {
           return with_attributes(mesh, targets, weight, options);
         }});
  };
  for (const float weight : texture_weights) add("simplifyWithAttributes", weight, 0);
#if MESHOPTIMIZER_VERSION >= 250
  for (const float weight : texture_weights) add("permissive", weight, meshopt_SimplifyPermissive);
#endif
#endif
  return result;
}

}  // namespace occlod::bench
