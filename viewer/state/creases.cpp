#include "creases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "base/threads.h"

namespace occlod::viewer {
namespace {

// Lists the triangles around each vertex.
class Stars {
 public:
  Stars(std::size_t vertex_count, std::span<const Triangle> triangles)
      : ends_(vertex_count + 1, 0), corners_(3 * triangles.size()) {
    for (const Triangle& t : triangles)
      for (int k = 0; k < 3; ++k) ++ends_[t[k] + 1];
    for (std::size_t v = 0; v < vertex_count; ++v) ends_[v + 1] += ends_[v];
    std::vector<std::size_t> next(ends_.begin(), ends_.end() - 1);
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) corners_[next[triangles[i][k]]++] = static_cast<std::uint32_t>(i);
  }

  [[nodiscard]] std::span<const std::uint32_t> around(std::size_t v) const {
    return std::span(corners_).subspan(ends_[v], ends_[v + 1] - ends_[v]);
  }

 private:
  std::vector<std::size_t> ends_;
  std::vector<std::uint32_t> corners_;
};

// Describes one side of an edge at the current vertex.
struct Spoke {
  VertexId to = 0;
  bool leaves = false;  // the triangle runs along it from the vertex; with equal winding, one of two neighbours does
  glm::dvec3 normal{0.0};
};

// Reuses its memory from vertex to vertex.
class CreaseFinder {
 public:
  CreaseFinder(std::span<const glm::vec3> positions, std::span<const Triangle> triangles)
      : positions_(positions), triangles_(triangles) {}

  [[nodiscard]] double angle_deg(VertexId v, std::span<const std::uint32_t> star) {
    spokes_.clear();
    for (const std::uint32_t t : star) add_spokes(v, triangles_[t]);
    std::sort(spokes_.begin(), spokes_.end(), [](const Spoke& a, const Spoke& b) { return a.to < b.to; });
    sharpest_ = {0.0, 0.0};
    bool open = false;
    for (std::size_t begin = 0, end = 0; begin < spokes_.size(); begin = end) {
      while (end < spokes_.size() && spokes_[end].to == spokes_[begin].to) ++end;
      if (end - begin == 1)
        open = true;
      else
        note(sharpest_pair(std::span(spokes_).subspan(begin, end - begin)));
    }
    if (open) note(180.0);
    return sharpest_[1];
  }

 private:
  void add_spokes(VertexId v, const Triangle& t) {
    const glm::dvec3 a(positions_[t.x]), b(positions_[t.y]), c(positions_[t.z]);
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double length = glm::length(cross);
    const glm::dvec3 normal = length > 0.0 ? cross / length : glm::dvec3(0.0);
    const int corner = t.x == v ? 0 : t.y == v ? 1 : 2;
    spokes_.push_back({t[(corner + 1) % 3], true, normal});
    spokes_.push_back({t[(corner + 2) % 3], false, normal});
  }

  // Triangles without area have no normal and count as level with everything.
  static double sharpest_pair(std::span<const Spoke> spokes) {
    double cosine = 1.0;
    for (std::size_t i = 0; i < spokes.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) {
        if (spokes[i].normal == glm::dvec3(0.0) || spokes[k].normal == glm::dvec3(0.0)) continue;
        const double turned = spokes[i].leaves == spokes[k].leaves ? -1.0 : 1.0;
        cosine = std::min(cosine, turned * glm::dot(spokes[i].normal, spokes[k].normal));
      }
    return glm::degrees(std::acos(std::max(cosine, -1.0)));
  }

  void note(double angle) {
    if (angle > sharpest_[0]) std::swap(angle, sharpest_[0]);
    sharpest_[1] = std::max(sharpest_[1], angle);
  }

  std::span<const glm::vec3> positions_;
  std::span<const Triangle> triangles_;
  std::vector<Spoke> spokes_;
  std::array<double, 2> sharpest_{0.0, 0.0};  // edges of the current vertex
};

}  // namespace

std::vector<std::uint8_t> find_creases(std::span<const glm::vec3> positions, std::span<const Triangle> triangles) {
  const Stars stars(positions.size(), triangles);
  std::vector<std::uint8_t> creases(positions.size());
  constexpr std::size_t a_task = 16'384;
  const auto find = [&](CreaseFinder& finder, std::size_t task) {
    for (std::size_t v = task * a_task; v < std::min((task + 1) * a_task, positions.size()); ++v) {
      const double angle = finder.angle_deg(static_cast<VertexId>(v), stars.around(v));
      creases[v] = static_cast<std::uint8_t>(std::lround(angle / crease_unit_deg));
    }
  };
  for_each_task(
      1 + positions.size() / a_task, thread_count(0), [&] { return CreaseFinder(positions, triangles); }, find, [] {});
  return creases;
}

}  // namespace occlod::viewer
