#include "cover/ellipsoids.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <random>
#include <utility>
#include <vector>

#include "hlod/draw/cover_model.h"

namespace occlod::bench {
namespace {

constexpr int width = 320, height = 240;
constexpr double pixels = static_cast<double>(width) * height;
constexpr double tan_half = 0.5773502691896257;  // 60 degrees up and down
constexpr double near = 1.0, far = 100.0;

struct Ellipsoid {
  glm::dvec3 center{0.0}, radii{1.0};  // along the axes; the eye is at the origin and looks along -z
};

double uniform(std::mt19937_64& random, double low, double high) {  // the same with every standard library
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
}

// Anywhere in the frustum, with radii up to `largest`; none reaches the near plane.
Ellipsoid random_ellipsoid(std::mt19937_64& random, double largest) {
  Ellipsoid result;
  for (int i = 0; i < 3; ++i) result.radii[i] = uniform(random, 0.02, 1.0) * largest;
  const double nearest = near + largest;
  const double t = uniform(random, 0.0, 1.0);
  const double z = std::cbrt(nearest * nearest * nearest + t * (far * far * far - nearest * nearest * nearest));
  result.center = {uniform(random, -1.0, 1.0) * z * tan_half * width / height,
                   uniform(random, -1.0, 1.0) * z * tan_half, -z};
  return result;
}

double box_area(const glm::dvec3& r) { return 8.0 * (r.x * r.y + r.y * r.z + r.z * r.x); }
// Thomsen's formula, within 1.1 %.
double ellipsoid_area(const glm::dvec3& r) {
  constexpr double p = 1.6075, pi = 3.141592653589793;
  const double a = std::pow(r.x, p), b = std::pow(r.y, p), c = std::pow(r.z, p);
  return 4.0 * pi * std::pow((a * b + b * c + c * a) / 3.0, 1.0 / p);
}

// In front of the box (all of it is behind the near plane).
double distance_to_box(const Ellipsoid& e) {
  return glm::length(glm::max(glm::abs(e.center) - e.radii, glm::dvec3(0.0)));
}

// Which pixels are covered.
class Image {
 public:
  void clear() {
    std::fill(covered_.begin(), covered_.end(), 0);
    count_ = 0;
  }
  [[nodiscard]] double covered() const { return count_ / pixels; }

  // Pixels of the box that are covered, and all, inside the image.
  struct Count {
    int covered = 0, all = 0;
  };
  [[nodiscard]] Count count_box(const Ellipsoid& e) const {
    Count count;
    for_each_pixel(e, [&](int x, int y, const glm::dvec3& ray) {
      if (!meets_box(e, ray)) return;
      ++count.all;
      count.covered += at(x, y);
    });
    return count;
  }
  void draw(const Ellipsoid& e) {
    for_each_pixel(e, [&](int x, int y, const glm::dvec3& ray) {
      char& pixel = covered_[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
      if (pixel != 0 || !meets_ellipsoid(e, ray)) return;
      pixel = 1;
      count_ += 1.0;
    });
  }

 private:
  [[nodiscard]] int at(int x, int y) const {
    return covered_[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
  }

  static bool meets_box(const Ellipsoid& e, const glm::dvec3& ray) {
    double first = 0.0, last = 1e30;
    for (int i = 0; i < 3; ++i) {
      const double a = (e.center[i] - e.radii[i]) / ray[i], b = (e.center[i] + e.radii[i]) / ray[i];
      first = std::max(first, std::min(a, b));
      last = std::min(last, std::max(a, b));
    }
    return first <= last;
  }
  static bool meets_ellipsoid(const Ellipsoid& e, const glm::dvec3& ray) {
    const glm::dvec3 d = ray / e.radii, c = e.center / e.radii;
    const double b = glm::dot(d, c);
    return b > 0.0 && b * b >= glm::dot(d, d) * (glm::dot(c, c) - 1.0);
  }

  // Of the rectangle around the box's projection.
  template <typename Visit>
  static void for_each_pixel(const Ellipsoid& e, const Visit& visit) {
    const double scale = height / (2.0 * tan_half);
    const double z0 = -e.center.z - e.radii.z, z1 = -e.center.z + e.radii.z;
    const auto range = [&](double low, double high, int size) {
      const double first = scale * std::min(low / z0, low / z1), last = scale * std::max(high / z0, high / z1);
      return std::pair(std::clamp(static_cast<int>(std::floor(0.5 * size + first)), 0, size),
                       std::clamp(static_cast<int>(std::ceil(0.5 * size + last)), 0, size));
    };
    const auto [x0, x1] = range(e.center.x - e.radii.x, e.center.x + e.radii.x, width);
    const auto [y0, y1] = range(e.center.y - e.radii.y, e.center.y + e.radii.y, height);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        visit(x, y, glm::dvec3((x + 0.5 - 0.5 * width) / scale, (y + 0.5 - 0.5 * height) / scale, -1.0));
  }

  std::vector<char> covered_ = std::vector<char>(static_cast<std::size_t>(width) * height);
  double count_ = 0.0;
};

class Experiment {
 public:
  Experiment(const EllipsoidOptions& options, CoverCounts& counts)
      : options_(options), random_(options.seed), counts_(counts) {}

  CoverageError run() {
    for (int i = 0; i < options_.runs; ++i) run_once();
    return {error_ / drawn_, std::sqrt(square_error_ / drawn_)};
  }

 private:
  void run_once() {
    std::vector<Ellipsoid> objects;
    for (int i = 0; i < options_.objects; ++i) objects.push_back(random_ellipsoid(random_, options_.largest));
    std::sort(objects.begin(), objects.end(),
              [](const Ellipsoid& a, const Ellipsoid& b) { return distance_to_box(a) < distance_to_box(b); });
    image_.clear();
    double covered = 0.0;
    for (const Ellipsoid& e : objects) covered = draw(e, covered);
  }

  // Returns c_scr with it.
  double draw(const Ellipsoid& e, double covered) {
    const hlod::ImageScale scale{height / (2.0 * tan_half), pixels, false};
    const double share = hlod::box_coverage(box_area(e.radii), distance_to_box(e), scale);
    if (const Image::Count count = image_.count_box(e); count.all > 0)
      counts_.add({covered, share, covered, share, count.covered == count.all});  // they fill the image
    image_.draw(e);
    covered = hlod::covered_with(
        covered, hlod::mesh_coverage(share, hlod::coverage_ratio(ellipsoid_area(e.radii), box_area(e.radii))));
    const double error = covered - image_.covered();
    drawn_ += 1.0;
    error_ += error;
    square_error_ += error * error;
    return covered;
  }

  EllipsoidOptions options_;
  std::mt19937_64 random_;
  CoverCounts& counts_;
  Image image_;
  double drawn_ = 0.0, error_ = 0.0, square_error_ = 0.0;
};

}  // namespace

CoverageError count_ellipsoids(const EllipsoidOptions& options, CoverCounts& counts) {
  return Experiment(options, counts).run();
}

}  // namespace occlod::bench
