#include "spatial_order.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/common.hpp>

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

std::vector<std::uint32_t> morton_codes(const std::vector<glm::vec3>& positions) {
  const Box box = bounding_box(positions);
  const glm::dvec3 low(box.min), size = glm::dvec3(box.max) - low;
  const double extent = std::max({size.x, size.y, size.z});
  const double scale = extent > 0.0 ? 1023.999 / extent : 0.0;
  std::vector<std::uint32_t> codes(positions.size());
  std::transform(positions.begin(), positions.end(), codes.begin(), [&](const glm::vec3& p) {
    const glm::dvec3 cell = (glm::dvec3(p) - low) * scale;
    return spread(static_cast<std::uint32_t>(cell.x)) | spread(static_cast<std::uint32_t>(cell.y)) << 1 |
           spread(static_cast<std::uint32_t>(cell.z)) << 2;
  });
  return codes;
}

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

TriangleMesh in_spatial_order(const TriangleMesh& mesh) {
  TriangleMesh result;
  const std::vector<std::uint32_t> order = sorted_by(morton_codes(mesh.positions));
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
