#include "splits/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "splits/star_mesh.h"

namespace occlod {
namespace {

constexpr float round_up = 1.0F + 1e-5F;
constexpr double most_lattice_cells = 1.0 / 8.0;  // of the number of triangles

glm::vec3 centroid(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return a + ((b - a) + (c - a)) * (1.0F / 3.0F);
}

glm::vec3 middle(const glm::vec3& a, const glm::vec3& b) { return a + (b - a) * 0.5F; }

}  // namespace

SurfaceSamples::SurfaceSamples(const TriangleMesh& mesh, const LevelFaces& levels) : mesh_(mesh), levels_(levels) {
  choose_limit();
  link_stars();
  radii_.assign(mesh.vertex_count(), -1.0F);
  std::vector<glm::vec3> corners;
  for (SampleId v = 0; v < mesh.vertex_count(); ++v) {
    corners.clear();
    append_corners(v, corners);
    for (const glm::vec3& corner : corners) radii_[v] = std::max(radii_[v], glm::distance(corner, mesh.positions[v]));
    radii_[v] *= round_up;
  }
  add_lattices();
  max_radius_ = std::max(0.0F, *std::max_element(radii_.begin(), radii_.end()));
}

float SurfaceSamples::longest_edge(const Triangle& t) const {
  const glm::vec3 &a = mesh_.positions[t.x], &b = mesh_.positions[t.y], &c = mesh_.positions[t.z];
  return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
}

std::uint32_t SurfaceSamples::divisions(const Triangle& t) const {
  return static_cast<std::uint32_t>(std::ceil(longest_edge(t) / limit_));
}

// Starts at the root mean square of the longest edges: few lattices on an even mesh.
void SurfaceSamples::choose_limit() {
  std::vector<float> lengths;
  lengths.reserve(mesh_.triangle_count());
  for (const Triangle& t : mesh_.triangles) lengths.push_back(longest_edge(t));
  double squares = 0.0;
  for (const float length : lengths) squares += static_cast<double>(length) * length;
  double limit = std::sqrt(squares / static_cast<double>(lengths.size()));
  const double most = most_lattice_cells * static_cast<double>(lengths.size()) + 16.0;
  const auto cells = [&] {
    double sum = 0.0;
    for (const float length : lengths)
      if (length > limit) sum += std::pow(std::ceil(length / limit), 2.0);
    return sum;
  };
  while (cells() > most) limit *= 1.1;
  limit_ = static_cast<float>(limit);
}

void SurfaceSamples::link_stars() {
  first_star_.assign(mesh_.vertex_count() + 2, 0);
  const auto for_each_corner = [&](const auto& visit) {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      if (longest_edge(mesh_.triangles[t]) <= limit_)
        for (int k = 0; k < 3; ++k) visit(mesh_.triangles[t][k], t);
  };
  for_each_corner([&](VertexId v, std::uint32_t) { ++first_star_[v + 2]; });
  for (std::size_t v = 2; v < first_star_.size(); ++v) first_star_[v] += first_star_[v - 1];
  stars_.resize(first_star_.back());
  for_each_corner([&](VertexId v, std::uint32_t t) { stars_[first_star_[v + 1]++] = t; });
  first_star_.pop_back();
}

void SurfaceSamples::add_lattices() {
  for (FaceId f = 0; f < levels_.face_count(); ++f) {
    const Triangle& t = levels_.corners(f);
    if (levels_.maker(f) != no_id || longest_edge(t) <= limit_) continue;
    const std::uint32_t n = divisions(t);
    for (std::uint32_t number = 0; number < n * n; ++number) {
      const Corners c = lattice_corners(t, number);
      const glm::vec3 point = centroid(c[0], c[1], c[2]);
      lattice_.push_back({f, number, point});
      radii_.push_back(std::max({glm::distance(point, c[0]), glm::distance(point, c[1]), glm::distance(point, c[2])}) *
                       round_up);
    }
  }
}

// Row i of the lattice, i = 0 at corner x, has 2 i + 1 triangles, every other one upside down: i^2 lie before it.
SurfaceSamples::Corners SurfaceSamples::lattice_corners(const Triangle& t, std::uint32_t number) const {
  const auto row = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(number)));
  const std::uint32_t column = number - row * row;
  const float step = 1.0F / static_cast<float>(divisions(t));
  const glm::vec3& origin = mesh_.positions[t.x];
  const glm::vec3 down = (mesh_.positions[t.y] - origin) * step;
  const glm::vec3 right = (mesh_.positions[t.z] - mesh_.positions[t.y]) * step;
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return origin + down * static_cast<float>(i) + right * static_cast<float>(j);
  };
  const std::uint32_t j = column / 2;
  if (column % 2 == 0) return {at(row, j), at(row + 1, j), at(row + 1, j + 1)};
  return {at(row, j), at(row + 1, j + 1), at(row, j + 1)};
}

void SurfaceSamples::append_corners(SampleId s, std::vector<glm::vec3>& out) const {
  if (s >= mesh_.vertex_count()) {
    const LatticeCell& cell = lattice_[s - mesh_.vertex_count()];
    const Corners corners = lattice_corners(levels_.corners(cell.face), cell.number);
    out.insert(out.end(), corners.begin(), corners.end());
    return;
  }
  const glm::vec3& p = mesh_.positions[s];
  for (std::uint32_t i = first_star_[s]; i < first_star_[s + 1]; ++i) {
    const Triangle t = rotated(mesh_.triangles[stars_[i]], s);
    const glm::vec3 &next = mesh_.positions[t.y], &last = mesh_.positions[t.z];
    out.insert(out.end(), {p, middle(p, next), centroid(p, next, last), middle(p, last)});
  }
}

}  // namespace occlod
