#include "splits/spatial_order.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "base/platform.h"
#include "base/threads.h"

namespace occlod {

// Each thread sorts a part of the items. Parts stay in order within each digit, so their number does not change the
// result.
void sort_by_key(UninitializedVector<Keyed>& items, unsigned key_bits, unsigned threads) {
  if (items.empty()) return;
  const unsigned rounds = std::max(1U, (key_bits + 10) / 11), digit_bits = (key_bits + rounds - 1) / rounds;
  const std::size_t digits = std::size_t{1} << digit_bits;
  UninitializedVector<Keyed> other(items.size());
  std::vector<std::size_t> starts(threads * digits);
  for (unsigned round = 0; round < rounds; ++round) {
    const auto digit_of = [&](const Keyed& item) { return item.key >> (round * digit_bits) & (digits - 1); };
    std::fill(starts.begin(), starts.end(), 0);
    for_each_part(items.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t part) {
      std::size_t* const counts = starts.data() + part * digits;
      for_each_short_range(begin, end, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) ++counts[digit_of(items[i])];
      });
    });
    std::size_t sum = 0;
    for (std::size_t digit = 0; digit < digits; ++digit)
      for (unsigned t = 0; t < threads; ++t) sum += std::exchange(starts[t * digits + digit], sum);
    for_each_part(items.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t part) {
      std::size_t* const next = starts.data() + part * digits;
      for_each_short_range(begin, end, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) other[next[digit_of(items[i])]++] = items[i];
      });
    });
    items.swap(other);
  }
}

namespace {

template <typename T>
std::vector<T> permuted(const std::vector<T>& values, const std::vector<VertexId>& order, unsigned threads) {
  std::vector<T> result(values.size());
  if (!values.empty()) for_each_id(order.size(), threads, [&](std::uint32_t i) { result[i] = values[order[i]]; });
  return result;
}

// Appends extra wedges in the new order of their vertices; the wedges of one vertex keep their order.
void add_extra_wedges(const TriangleMesh& mesh, WedgeOrder& order) {
  const std::size_t vertices = mesh.vertex_count();
  for (auto w = static_cast<WedgeId>(vertices); w < mesh.wedge_count(); ++w) order.old_id.push_back(w);
  std::stable_sort(
      order.old_id.begin() + static_cast<std::ptrdiff_t>(vertices), order.old_id.end(),
      [&](WedgeId a, WedgeId b) { return order.new_id[mesh.vertex_of(a)] < order.new_id[mesh.vertex_of(b)]; });
  order.new_id.resize(order.old_id.size());
  for (std::size_t i = vertices; i < order.old_id.size(); ++i) order.new_id[order.old_id[i]] = static_cast<WedgeId>(i);
}

}  // namespace

void sort_spatially(const PositionView& positions, const MortonCurve& curve, std::span<VertexId> vertices,
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

WedgeOrder spatial_order_of(const TriangleMesh& mesh, std::vector<VertexId> vertices, unsigned threads) {
  WedgeOrder order;
  order.old_id = std::move(vertices);
  sort_spatially(mesh.positions, {bounding_box(mesh.positions), glm::dvec3(0.0), 10}, order.old_id, threads);
  order.new_id.resize(order.old_id.size());
  for_each_id(order.old_id.size(), threads, [&](VertexId i) { order.new_id[order.old_id[i]] = i; });
  add_extra_wedges(mesh, order);
  return order;
}

std::vector<VertexId> in_order_of_use(std::span<const Triangle> triangles, std::size_t count) {
  std::vector<VertexId> vertices;
  vertices.reserve(count);
  std::vector<bool> is_listed(count);
  const auto list = [&](VertexId v) {
    if (is_listed[v]) return;
    is_listed[v] = true;
    vertices.push_back(v);
  };
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) list(t[k]);
  for (VertexId v = 0; vertices.size() < count; ++v) list(v);
  return vertices;
}

TriangleMesh in_spatial_order(const TriangleMesh& mesh, unsigned threads) {
  TriangleMesh result;
  std::vector<VertexId> vertices(mesh.vertex_count());
  std::iota(vertices.begin(), vertices.end(), 0U);
  const auto [order, new_id] = spatial_order_of(mesh, std::move(vertices), threads);
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
  result.origin = mesh.origin;
  result.up = mesh.up;
  result.triangles.resize(mesh.triangles.size());
  for_each_id(mesh.triangles.size(), threads, [&, &new_id = new_id](std::uint32_t f) {
    const Triangle& t = mesh.triangles[f];
    result.triangles[f] = {new_id[t.x], new_id[t.y], new_id[t.z]};
  });
  result.corners.resize(mesh.corners.size());
  for_each_id(mesh.corners.size(), threads, [&, &new_id = new_id](std::uint32_t f) {
    const Triangle& t = mesh.corners[f];
    result.corners[f] = {new_id[t.x], new_id[t.y], new_id[t.z]};
  });
  return result;
}

}  // namespace occlod
