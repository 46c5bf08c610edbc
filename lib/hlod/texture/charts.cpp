#include "hlod/texture/charts.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>

#include "base/disjoint_sets.h"
#include "occlod/base.h"

namespace occlod::tiles {
namespace {

// Returns, per vertex, the first vertex at the same place in space and in the image.
std::vector<std::uint32_t> first_at_place(const ChartMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.positions.size()), first(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t v) {
    const glm::vec3& p = mesh.positions[v];
    const glm::dvec2& uv = mesh.texels[v];
    return std::tuple(mesh.images[v], p.x, p.y, p.z, uv.x, uv.y);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

void add_triangle(Chart& chart, const ChartMesh& mesh, std::uint32_t t) {
  const Triangle& triangle = mesh.triangles[t];
  for (int k = 0; k < 3; ++k) {
    chart.min = glm::min(chart.min, mesh.texels[triangle[k]]);
    chart.max = glm::max(chart.max, mesh.texels[triangle[k]]);
  }
  const glm::dvec2 uv = mesh.texels[triangle.x];
  const glm::dvec2 ab = mesh.texels[triangle.y] - uv, ac = mesh.texels[triangle.z] - uv;
  chart.texels += 0.5 * std::abs(ab.x * ac.y - ab.y * ac.x);
  const glm::dvec3 p(mesh.positions[triangle.x]);
  chart.area += 0.5 * glm::length(glm::cross(glm::dvec3(mesh.positions[triangle.y]) - p,
                                             glm::dvec3(mesh.positions[triangle.z]) - p));
  chart.triangles.push_back(t);
}

}  // namespace

glm::i64vec2 Chart::first_texel(double scale) const noexcept { return glm::i64vec2(glm::floor(min * scale)); }

glm::i64vec2 Chart::texel_counts(double scale) const noexcept {
  return glm::max(glm::i64vec2(glm::ceil(max * scale)) - first_texel(scale), glm::i64vec2(1));
}

double Chart::texel_size() const noexcept {
  return texels > 0.0 ? std::sqrt(area / texels) : std::numeric_limits<double>::infinity();
}

std::vector<Chart> find_charts(const ChartMesh& mesh) {
  const std::vector<std::uint32_t> first = first_at_place(mesh);
  DisjointSets sets;
  sets.reset(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.images[mesh.triangles[t].x] == no_id) continue;
    const Triangle& triangle = mesh.triangles[t];
    sets.join(first[triangle.x], first[triangle.y]);
    sets.join(first[triangle.x], first[triangle.z]);
  }
  std::vector<std::uint32_t> chart_of(mesh.positions.size(), no_id);  // by set
  std::vector<Chart> charts;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.images[mesh.triangles[t].x] == no_id) continue;
    std::uint32_t& chart = chart_of[sets.root(first[mesh.triangles[t].x])];
    if (chart == no_id) {
      chart = static_cast<std::uint32_t>(charts.size());
      charts.emplace_back().image = mesh.images[mesh.triangles[t].x];
    }
    add_triangle(charts[chart], mesh, t);
  }
  return charts;
}

}  // namespace occlod::tiles
