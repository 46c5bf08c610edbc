#include "attribute_distance.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <vector>

#include "area_sampler.h"
#include "texture_tree.h"
#include "triangle_distance.h"

namespace occlod::measure {
namespace {

constexpr double tie = 1e-6;  // relative to the diagonal: points of B within this of the nearest count as nearest
// A triangle's texture gradient is trusted between this and its inverse, relative to that of the whole mesh.
constexpr double min_scale = 1e-3;

struct Corners {
  std::array<glm::dvec3, 3> position;
  std::array<glm::dvec2, 3> texture;
};

Corners corners_of(const TriangleMesh& mesh, std::uint32_t triangle) {
  Corners corners;
  const Triangle& t = mesh.wedge_triangles()[triangle];
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    corners.position[at] = mesh.positions[t[i]];
    corners.texture[at] =
        mesh.texture_coordinates.empty() ? glm::dvec2(0.0) : glm::dvec2(mesh.texture_coordinates[t[i]]);
  }
  return corners;
}

double diagonal_of(const TriangleMesh& mesh) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const Triangle& triangle : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      low = glm::min(low, glm::dvec3(mesh.positions[triangle[i]]));
      high = glm::max(high, glm::dvec3(mesh.positions[triangle[i]]));
    }
  return glm::distance(low, high);
}

// Returns object units per unit of the texture: the root of the area in space over that in the texture.
double texture_scale_of(const TriangleMesh& mesh) {
  double area = 0.0, texture_area = 0.0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Corners c = corners_of(mesh, i);
    const glm::dvec2 s = c.texture[1] - c.texture[0], t = c.texture[2] - c.texture[0];
    area += glm::length(glm::cross(c.position[1] - c.position[0], c.position[2] - c.position[0]));
    texture_area += std::abs(s.x * t.y - s.y * t.x);
  }
  return area > 0.0 && texture_area > 0.0 ? std::sqrt(area / texture_area) : 1.0;
}

// Measures how long a step in the texture is on the surface.
class TextureMetric {
 public:
  // Uses the triangle's gradient, or only `scale` where its texture has no area or is stretched beyond reason.
  TextureMetric(const Corners& c, double scale) : gradient_(scale), least_(scale) {
    const glm::dmat2 texture(c.texture[1] - c.texture[0], c.texture[2] - c.texture[0]);
    const double area = texture[0].x * texture[1].y - texture[0].y * texture[1].x;
    const glm::dvec3 u = c.position[1] - c.position[0], v = c.position[2] - c.position[0];
    // This is d position / d texture, as coefficients of u and v; then as lengths: the first fundamental form.
    const glm::dmat2 inverse =
        glm::dmat2(texture[1].y, -texture[0].y, -texture[1].x, texture[0].x) * (area != 0.0 ? 1.0 / area : 0.0);
    const glm::dvec3 ds = inverse[0].x * u + inverse[0].y * v, dt = inverse[1].x * u + inverse[1].y * v;
    const double ss = glm::dot(ds, ds), st = glm::dot(ds, dt), tt = glm::dot(dt, dt);
    const double mean = (ss + tt) / 2.0, spread = std::hypot((ss - tt) / 2.0, st);
    const double low = std::sqrt(std::max(mean - spread, 0.0)), high = std::sqrt(mean + spread);
    if (!(low >= min_scale * scale && high <= scale / min_scale)) return;
    form_ = glm::dmat2(ss, st, st, tt);
    least_ = low;
    gradient_ = 0.0;
  }

  [[nodiscard]] double length(const glm::dvec2& step) const {
    if (gradient_ > 0.0) return gradient_ * glm::length(step);
    return std::sqrt(std::max(glm::dot(step, form_ * step), 0.0));
  }
  // Returns a factor such that no step is shorter than its length in the texture times it, up to rounding.
  [[nodiscard]] double least() const { return 0.999'999 * least_; }

 private:
  glm::dmat2 form_{0.0};
  double gradient_;  // 0: the form counts
  double least_;
};

// Returns, for B's materials, the numbers of A's with the same names.
std::vector<MaterialId> matched_materials(const TriangleMesh& a, const TriangleMesh& b) {
  std::vector<MaterialId> matched;
  for (std::size_t i = 0; i < b.materials.size(); ++i) {
    matched.push_back(static_cast<MaterialId>(i));
    if (b.materials[i].name.empty()) continue;
    const auto same = std::find_if(a.materials.begin(), a.materials.end(),
                                   [&](const Material& m) { return m.name == b.materials[i].name; });
    if (same != a.materials.end()) matched.back() = static_cast<MaterialId>(same - a.materials.begin());
  }
  return matched;
}

// Describes a sample of A.
struct Sample {
  glm::dvec3 position;
  glm::dvec2 texture;
  MaterialId material;
  std::uint32_t triangle;
  glm::dvec3 weights;
};

class Comparison {
 public:
  Comparison(const TriangleMesh& a, const TriangleMesh& b, const AttributeOptions& options)
      : a_(a),
        b_(b),
        diagonal_(diagonal_of(a)),
        radius_(options.search_radius * diagonal_),
        scale_(texture_scale_of(a)),
        has_texture_(!a.texture_coordinates.empty() && !b.texture_coordinates.empty()),
        has_materials_(!a.triangle_materials.empty() && !b.triangle_materials.empty()),
        flip_(a.texture_origin != b.texture_origin) {
    grow_trees();
  }

  void add(const Sample& sample) {
    ++samples_;
    const Nearest nearest = nearest_to(sample.position);
    if (has_texture_) add_slip(sample, nearest);
    if (!a_.normals.empty() && !b_.normals.empty())
      add(normals_, smallest(sample, nearest.distance, [&](auto... points) { return angle_deg(points...); }));
    if (!a_.colors.empty() && !b_.colors.empty())
      add(colors_, smallest(sample, nearest.distance, [&](auto... points) { return color_difference(points...); }));
  }

  [[nodiscard]] AttributeDistance result() const {
    AttributeDistance result;
    const auto count = static_cast<double>(samples_);
    if (has_texture_) {
      result.texture = slip_;
      result.texture->rms = std::sqrt(slip_.rms / count);
      result.texture->radius = radius_;
    }
    if (!a_.normals.empty() && !b_.normals.empty()) result.normals = {std::sqrt(normals_.rms / count), normals_.max};
    if (!a_.colors.empty() && !b_.colors.empty()) result.colors = {std::sqrt(colors_.rms / count), colors_.max};
    return result;
  }

 private:
  struct Nearest {
    glm::dvec3 point{0.0};
    glm::dvec3 weights{0.0};
    std::uint32_t triangle = 0;
    double distance = std::numeric_limits<double>::infinity();
  };

  // Makes one tree per material of A; only one if either mesh has no materials.
  void grow_trees() {
    const std::vector<MaterialId> matched = matched_materials(a_, b_);
    std::vector<std::vector<std::uint32_t>> triangles(1);
    for (std::uint32_t i = 0; i < b_.triangles.size(); ++i) {
      std::size_t material = has_materials_ ? std::size_t{b_.material_of(i)} : 0;
      if (material < matched.size() && has_materials_) material = matched[material];
      if (material >= triangles.size()) triangles.resize(material + 1);
      triangles[material].push_back(i);
    }
    tree_of_.resize(triangles.size(), no_tree);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (triangles[i].empty()) continue;
      tree_of_[i] = trees_.size();
      trees_.emplace_back(b_, std::move(triangles[i]), scale_);
    }
  }

  [[nodiscard]] Nearest nearest_to(const glm::dvec3& position) const {
    Nearest nearest;
    for (const TextureTree& tree : trees_)
      tree.visit([&](const TextureBox& box) { return box.distance(position); }, [&] { return nearest.distance; },
                 [&](std::uint32_t triangle) {
                   const Corners c = corners_of(b_, triangle);
                   const TrianglePoint found =
                       nearest_on_triangle(position, c.position[0], c.position[1], c.position[2]);
                   const double distance = glm::distance(found.point, position);
                   if (distance < nearest.distance) nearest = {found.point, found.weights, triangle, distance};
                 });
    return nearest;
  }

  // Returns the smallest difference(sample, triangle of B, weights in it) of those triangles that are nearest.
  template <typename Difference>
  double smallest(const Sample& sample, double distance, const Difference& difference) const {
    const double reach = std::nextafter(distance + tie * diagonal_, std::numeric_limits<double>::infinity());
    double least = std::numeric_limits<double>::infinity();
    for (const TextureTree& tree : trees_)
      tree.visit([&](const TextureBox& box) { return box.distance(sample.position); }, [&] { return reach; },
                 [&](std::uint32_t triangle) {
                   const Corners c = corners_of(b_, triangle);
                   const TrianglePoint found =
                       nearest_on_triangle(sample.position, c.position[0], c.position[1], c.position[2]);
                   if (glm::distance(found.point, sample.position) <= reach)
                     least = std::min(least, difference(sample, triangle, found.weights));
                 });
    return least;
  }

  void add_slip(const Sample& sample, const Nearest& nearest) {
    const double slip = slip_of(sample, nearest.point);
    slip_.rms += slip * slip;
    slip_.lost += slip >= radius_ ? 1 : 0;
    if (slip > slip_.max || samples_ == 1) slip_.max = slip, slip_.max_at = sample.position;
  }

  [[nodiscard]] double slip_of(const Sample& sample, const glm::dvec3& home) const {
    const std::size_t material = has_materials_ ? std::size_t{sample.material} : 0;
    if (material >= tree_of_.size() || tree_of_[material] == no_tree) return radius_;
    glm::dvec2 texture = sample.texture;
    if (flip_) texture.y = 1.0 - texture.y;
    Corners around = corners_of(a_, sample.triangle);
    if (flip_)
      for (glm::dvec2& t : around.texture) t.y = 1.0 - t.y;
    const TextureMetric metric(around, scale_);
    double least = radius_;
    trees_[tree_of_[material]].visit(
        [&](const TextureBox& box) { return box.distance(home) + metric.least() * box.texture_distance(texture); },
        [&] { return least; },
        [&](std::uint32_t triangle) {
          const Corners c = corners_of(b_, triangle);
          const auto try_point = [&](const glm::dvec3& weights) {
            const glm::dvec3 q = at(weights, c.position[0], c.position[1], c.position[2]);
            const glm::dvec2 t = at(weights, c.texture[0], c.texture[1], c.texture[2]);
            least = std::min(least, glm::distance(q, home) + metric.length(t - texture));
          };
          // The sum is least at one of these, except for rare shapes in which both lengths are long.
          try_point(nearest_on_triangle({texture, 0.0}, {c.texture[0], 0.0}, {c.texture[1], 0.0}, {c.texture[2], 0.0})
                        .weights);
          try_point(nearest_on_triangle(home, c.position[0], c.position[1], c.position[2]).weights);
        });
    return least;
  }

  static glm::dvec3 normal_at(const TriangleMesh& mesh, std::uint32_t triangle, const glm::dvec3& weights) {
    const Triangle& t = mesh.wedge_triangles()[triangle];
    return at(weights, glm::dvec3(mesh.normals[t.x]), glm::dvec3(mesh.normals[t.y]), glm::dvec3(mesh.normals[t.z]));
  }

  // Returns 0 where a normal has no direction. acos() cannot resolve small angles, hence atan2().
  [[nodiscard]] double angle_deg(const Sample& sample, std::uint32_t triangle, const glm::dvec3& weights) const {
    const glm::dvec3 a = normal_at(a_, sample.triangle, sample.weights), b = normal_at(b_, triangle, weights);
    return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
  }

  static glm::dvec3 color_at(const TriangleMesh& mesh, std::uint32_t triangle, const glm::dvec3& weights) {
    const Triangle& t = mesh.wedge_triangles()[triangle];
    return at(weights, glm::dvec3(mesh.colors[t.x]), glm::dvec3(mesh.colors[t.y]), glm::dvec3(mesh.colors[t.z])) /
           255.0;
  }

  [[nodiscard]] double color_difference(const Sample& sample, std::uint32_t triangle, const glm::dvec3& weights) const {
    const glm::dvec3 a = color_at(a_, sample.triangle, sample.weights), b = color_at(b_, triangle, weights);
    return glm::distance(a, b) / std::sqrt(3.0);
  }

  static void add(AttributeDifference& sum, double difference) {
    sum.rms += difference * difference;
    sum.max = std::max(sum.max, difference);
  }

  static constexpr std::size_t no_tree = ~std::size_t{0};

  const TriangleMesh& a_;
  const TriangleMesh& b_;
  double diagonal_;
  double radius_;
  double scale_;
  bool has_texture_;
  bool has_materials_;
  bool flip_;
  std::vector<TextureTree> trees_;
  std::vector<std::size_t> tree_of_;  // per material
  std::size_t samples_ = 0;
  TextureSlip slip_;             // rms holds the sum of squares
  AttributeDifference normals_;  // rms holds the sum of squares
  AttributeDifference colors_;   // rms holds the sum of squares
};

}  // namespace

AttributeDistance attribute_distance(const TriangleMesh& a, const TriangleMesh& b, const AttributeOptions& options) {
  assert(!a.triangles.empty() && !b.triangles.empty() && options.samples > 0 && options.search_radius > 0.0);
  Comparison comparison(a, b, options);
  const AreaSampler sampler(a.positions, a.triangles);
  sampler.visit(options.samples, options.seed, [&](const SurfacePoint& point) {
    const Corners c = corners_of(a, point.triangle);
    comparison.add({sampler.position(point), at(point.weights, c.texture[0], c.texture[1], c.texture[2]),
                    a.material_of(point.triangle), point.triangle, point.weights});
  });
  return comparison.result();
}

}  // namespace occlod::measure
