// Meshes reduced in one call, and what values of the input belong to the result. occlod/_simplify.py makes one function
// of it.
#include "occlod/simplify.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"

namespace occlod::python {
namespace {

using namespace nb::literals;

SimplifyOptions options_of(bool refit, int threads, const std::optional<nb::callable>& progress) {
  SimplifyOptions options;
  options.refit = refit;
  options.threads = threads;
  options.progress = progress_of(progress ? nb::handle(*progress) : nb::handle(Py_None));
  return options;
}

// A k-d tree without nodes: the median of each range splits it, along the axis in which the range is widest.
class NearestPoint {
 public:
  explicit NearestPoint(std::vector<glm::dvec3> points)
      : points_(std::move(points)), order_(points_.size()), axes_(points_.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    split(0, order_.size());
  }

  // Returns the index of a point nearest to p. Expected O(log n).
  [[nodiscard]] std::uint32_t find(const glm::dvec3& p) const {
    Best best;
    search(p, 0, order_.size(), best);
    return best.point;
  }

 private:
  struct Best {
    std::uint32_t point = 0;
    double square = std::numeric_limits<double>::infinity();
  };

  void split(std::size_t first, std::size_t end) {
    if (end - first < 2) return;
    glm::dvec3 low = points_[order_[first]], high = low;
    for (std::size_t i = first; i < end; ++i) {
      low = glm::min(low, points_[order_[i]]);
      high = glm::max(high, points_[order_[i]]);
    }
    const glm::dvec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = first + (end - first) / 2;
    const auto at = [this](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(first), at(middle), at(end),
                     [this, axis](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
    axes_[middle] = static_cast<std::uint8_t>(axis);
    split(first, middle);
    split(middle + 1, end);
  }

  void search(const glm::dvec3& p, std::size_t first, std::size_t end, Best& best) const {
    if (first == end) return;
    const std::size_t middle = first + (end - first) / 2;
    const glm::dvec3 away = p - points_[order_[middle]];
    if (const double square = glm::dot(away, away); square < best.square) best = {order_[middle], square};
    const double side = away[axes_[middle]];
    const auto below = [&] { search(p, first, middle, best); };
    const auto above = [&] { search(p, middle + 1, end, best); };
    if (side < 0.0) {
      below();
      if (side * side < best.square) above();
    } else {
      above();
      if (side * side < best.square) below();
    }
  }

  std::vector<glm::dvec3> points_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint8_t> axes_;
};

std::vector<glm::dvec3> finite_points(const ArrayLike& array, const char* name) {
  const nb::object values = contiguous(array, name, "float64", 3);
  std::vector<glm::dvec3> points(nb::cast<std::size_t>(values.attr("shape")[nb::int_(0)]));
  const auto address = nb::cast<std::uintptr_t>(values.attr("ctypes").attr("data"));
  if (!points.empty())
    std::memcpy(points.data(), reinterpret_cast<const void*>(address), points.size() * sizeof(glm::dvec3));  // NOLINT
  for (const glm::dvec3& point : points)
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z))
      throw nb::value_error((std::string(name) + ": are not all finite; leave those out that are not").c_str());
  return points;
}

std::vector<std::uint32_t> nearest(const std::vector<glm::dvec3>& queries, std::vector<glm::dvec3> points) {
  const NearestPoint tree(std::move(points));
  std::vector<std::uint32_t> found;
  found.reserve(queries.size());
  for (const glm::dvec3& query : queries) found.push_back(tree.find(query));
  return found;
}

}  // namespace

void bind_simplify(nb::module_& m) {
  m.def(
      "simplify_to_triangles",
      [](const TriangleMesh& mesh, std::size_t triangles, bool refit, int threads,
         const std::optional<nb::callable>& progress) {
        const SimplifyOptions options = options_of(refit, threads, progress);
        const ReleasedGil release;
        require_valid(mesh);
        return simplify(mesh, triangles, options);
      },
      "mesh"_a, "triangles"_a, nb::kw_only(), "refit"_a = true, "threads"_a = 0, "progress"_a = nb::none(),
      "The mesh, which is as clean() leaves it, with at most so many triangles. See simplify().");
  m.def(
      "simplify_to_distance",
      [](const TriangleMesh& mesh, double distance, bool refit, int threads,
         const std::optional<nb::callable>& progress) {
        const SimplifyOptions options = options_of(refit, threads, progress);
        const ReleasedGil release;
        require_valid(mesh);
        return simplify_within(mesh, distance, options).mesh;
      },
      "mesh"_a, "distance"_a, nb::kw_only(), "refit"_a = true, "threads"_a = 0, "progress"_a = nb::none(),
      "The mesh, which is as clean() leaves it, with as few triangles as leave no point of either surface farther\n"
      "from the other, object units. See simplify().");
  m.def(
      "nearest_points",
      [](const ArrayLike& queries, const ArrayLike& points) {
        const std::vector<glm::dvec3> asked = finite_points(queries, "queries");
        std::vector<glm::dvec3> known = finite_points(points, "points");
        if (known.empty() && !asked.empty()) throw nb::value_error("points: are none; give at least one");
        std::vector<std::uint32_t> found;
        {
          const ReleasedGil release;
          found = nearest(asked, std::move(known));
        }
        return array_of(std::move(found));
      },
      "queries"_a, "points"_a,
      "(k,) uint32: for each of the (k, 3) queries one of the (n, 3) points that is nearest to it. ValueError for\n"
      "what is not finite, and without points. Expected O((n + k) log n).");
}

}  // namespace occlod::python
