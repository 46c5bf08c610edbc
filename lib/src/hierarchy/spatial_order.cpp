#include "spatial_order.h"

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <limits>
#include <numeric>

#include "core/platform.h"
#include "parallel.h"
#include "sort_by_key.h"

namespace occlod {
namespace {

// Spreads the lower 10 bits of x to every third bit.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffU;
  x = (x | x << 8) & 0x0300f00fU;
  x = (x | x << 4) & 0x030c30c3U;
  return (x | x << 2) & 0x09249249U;
}

// Positions to codes.
class MortonGrid {
 public:
  explicit MortonGrid(const MortonCurve& curve) {
    const glm::dvec3 size = glm::dvec3(curve.box.max) - glm::dvec3(curve.box.min);
    const double extent = std::max({size.x, size.y, size.z});
    const double cells = static_cast<double>(1U << curve.bits);
    last_cell_ = static_cast<float>(cells - 1.0);
    origin_ = glm::vec3(glm::dvec3(curve.box.min) - curve.shift * extent);
    // Finite also where the extent is denormal: cells are wider than it then.
    constexpr double most = std::numeric_limits<float>::max();
    cells_per_unit_ = extent > 0.0 ? static_cast<float>(std::min(cells / (2.0 * extent), most)) : 0.0F;
  }
  [[nodiscard]] std::uint32_t code(const glm::vec3& p) const {
    const glm::vec3 cell = glm::min((p - origin_) * cells_per_unit_, last_cell_);
    return spread(static_cast<std::uint32_t>(cell.x)) | spread(static_cast<std::uint32_t>(cell.y)) << 1 |
           spread(static_cast<std::uint32_t>(cell.z)) << 2;
  }

 private:
  glm::vec3 origin_{0.0F};
  float cells_per_unit_ = 0.0F;
  float last_cell_ = 0.0F;
};

template <typename T>
std::vector<T> permuted(const std::vector<T>& values, const std::vector<VertexId>& order, unsigned threads) {
  std::vector<T> result(values.size());
  if (!values.empty()) for_each_id(order.size(), threads, [&](std::uint32_t i) { result[i] = values[order[i]]; });
  return result;
}

// Extra wedges follow in the new order of their vertices, those of one as they were.
void add_extra_wedges(const TriangleMesh& mesh, std::vector<WedgeId>& new_id, std::vector<WedgeId>& order) {
  const std::size_t vertices = mesh.vertex_count();
  for (auto w = static_cast<WedgeId>(vertices); w < mesh.wedge_count(); ++w) order.push_back(w);
  std::stable_sort(order.begin() + static_cast<std::ptrdiff_t>(vertices), order.end(),
                   [&](WedgeId a, WedgeId b) { return new_id[mesh.vertex_of(a)] < new_id[mesh.vertex_of(b)]; });
  new_id.resize(order.size());
  for (std::size_t i = vertices; i < order.size(); ++i) new_id[order[i]] = static_cast<WedgeId>(i);
}

}  // namespace

void sort_spatially(const PositionView& positions, const MortonCurve& curve, std::vector<VertexId>& vertices,
                    unsigned threads) {
  const MortonGrid grid(curve);
  UninitializedVector<Keyed> keyed(vertices.size());
  for_each_id(vertices.size(), threads, [&](std::uint32_t i) {
    constexpr std::size_t ahead = 16;
    if (i + ahead < vertices.size()) prefetch(&positions[vertices[i + ahead]]);
    keyed[i] = {grid.code(positions[vertices[i]]), vertices[i]};
  });
  sort_by_key(keyed, 3 * curve.bits, threads);
  for_each_id(vertices.size(), threads, [&](std::uint32_t i) { vertices[i] = keyed[i].item; });
}

TriangleMesh in_spatial_order(const TriangleMesh& mesh, unsigned threads) {
  TriangleMesh result;
  std::vector<VertexId> order(mesh.vertex_count());
  std::iota(order.begin(), order.end(), 0U);
  sort_spatially(mesh.positions, {bounding_box(mesh.positions), glm::dvec3(0.0), 10}, order, threads);
  std::vector<VertexId> new_id(order.size());
  for_each_id(order.size(), threads, [&](VertexId i) { new_id[order[i]] = i; });
  add_extra_wedges(mesh, new_id, order);
  result.positions = permuted(mesh.positions, order, threads);
  result.normals = permuted(mesh.normals, order, threads);
  result.colors = permuted(mesh.colors, order, threads);
  result.texture_coordinates = permuted(mesh.texture_coordinates, order, threads);
  for (std::size_t i = mesh.vertex_count(); i < order.size(); ++i)
    result.extra_wedges.push_back(new_id[mesh.vertex_of(order[i])]);
  result.triangle_materials = mesh.triangle_materials;
  result.materials = mesh.materials;
  result.textures = mesh.textures;
  result.texture_origin = mesh.texture_origin;
  result.triangles.resize(mesh.triangles.size());
  for_each_id(mesh.triangles.size(), threads, [&](std::uint32_t f) {
    const Triangle& t = mesh.triangles[f];
    result.triangles[f] = {new_id[t.x], new_id[t.y], new_id[t.z]};
  });
  result.corners.resize(mesh.corners.size());
  for_each_id(mesh.corners.size(), threads, [&](std::uint32_t f) {
    const Triangle& t = mesh.corners[f];
    result.corners[f] = {new_id[t.x], new_id[t.y], new_id[t.z]};
  });
  return result;
}

}  // namespace occlod
