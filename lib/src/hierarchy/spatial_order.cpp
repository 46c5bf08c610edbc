#include "spatial_order.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <numeric>

#include "occlod/math/bounds.h"

namespace occlod {
namespace {

// Spreads the lower 10 bits of x to every third bit.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffU;
  x = (x | x << 8) & 0x0300f00fU;
  x = (x | x << 4) & 0x030c30c3U;
  return (x | x << 2) & 0x09249249U;
}

// Positions to codes on a grid of 1024^3 cells over twice the extent of `all`, moved by `shift` of it.
class MortonGrid {
 public:
  MortonGrid(std::span<const glm::vec3> all, const glm::dvec3& shift) {
    const Box box = bounding_box(all);
    const glm::dvec3 size = glm::dvec3(box.max) - glm::dvec3(box.min);
    const double extent = std::max({size.x, size.y, size.z});
    origin_ = glm::dvec3(box.min) - shift * extent;
    cells_per_unit_ = extent > 0.0 ? 1023.999 / (2.0 * extent) : 0.0;
  }
  [[nodiscard]] std::uint32_t code(const glm::vec3& p) const {
    const glm::dvec3 cell = (glm::dvec3(p) - origin_) * cells_per_unit_;
    return spread(static_cast<std::uint32_t>(cell.x)) | spread(static_cast<std::uint32_t>(cell.y)) << 1 |
           spread(static_cast<std::uint32_t>(cell.z)) << 2;
  }

 private:
  glm::dvec3 origin_{0.0};
  double cells_per_unit_ = 0.0;
};

// Indices in ascending order of their keys, equal keys in their old order: radix sort by 11 bits.
std::vector<std::uint32_t> sorted_by(const std::vector<std::uint32_t>& keys) {
  std::vector<std::uint32_t> order(keys.size()), other(keys.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  for (const unsigned shift : {0U, 11U, 22U}) {
    std::array<std::size_t, 2049> starts{};
    for (const std::uint32_t key : keys) ++starts[(key >> shift & 2047U) + 1];
    for (std::size_t i = 1; i < starts.size(); ++i) starts[i] += starts[i - 1];
    for (const std::uint32_t i : order) other[starts[keys[i] >> shift & 2047U]++] = i;
    order.swap(other);
  }
  return order;
}

template <typename T>
std::vector<T> permuted(const std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  std::vector<T> result;
  result.reserve(values.size());
  if (!values.empty())
    for (const std::uint32_t i : order) result.push_back(values[i]);
  return result;
}

}  // namespace

void sort_spatially(std::span<const glm::vec3> positions, const glm::dvec3& shift, std::vector<VertexId>& vertices) {
  const MortonGrid grid(positions, shift);
  std::vector<std::uint32_t> codes(vertices.size());
  std::transform(vertices.begin(), vertices.end(), codes.begin(), [&](VertexId v) { return grid.code(positions[v]); });
  vertices = permuted(vertices, sorted_by(codes));
}

TriangleMesh in_spatial_order(const TriangleMesh& mesh) {
  TriangleMesh result;
  std::vector<VertexId> order(mesh.vertex_count());
  std::iota(order.begin(), order.end(), 0U);
  sort_spatially(mesh.positions, glm::dvec3(0.0), order);
  result.positions = permuted(mesh.positions, order);
  result.normals = permuted(mesh.normals, order);
  result.colors = permuted(mesh.colors, order);
  std::vector<VertexId> new_id(order.size());
  for (VertexId v = 0; v < order.size(); ++v) new_id[order[v]] = v;
  std::vector<std::uint32_t> first_vertex(mesh.triangles.size());
  std::transform(mesh.triangles.begin(), mesh.triangles.end(), first_vertex.begin(), [&](const Triangle& t) {
    return std::min({new_id[t.x], new_id[t.y], new_id[t.z]});
  });
  result.triangles = permuted(mesh.triangles, sorted_by(first_vertex));
  for (Triangle& t : result.triangles) t = {new_id[t.x], new_id[t.y], new_id[t.z]};
  return result;
}

}  // namespace occlod
