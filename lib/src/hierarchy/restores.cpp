#include <algorithm>
#include <array>
#include <bit>
#include <tuple>

#include "occlod/hierarchy/cut_mesh.h"
#include "occlod/hierarchy/validate.h"

namespace occlod {
namespace {

using Key = std::array<std::uint32_t, 9>;  // the bits of three corners, the smallest corner first, in winding order

// The bits of the number that the coordinate is: -0 is 0.
std::uint32_t bits(float x) { return std::bit_cast<std::uint32_t>(x + 0.0F); }

Key key_of(const Triangle& t, std::span<const glm::vec3> positions) {
  using Corner = std::array<std::uint32_t, 3>;
  std::array<Corner, 3> corners;
  for (int k = 0; k < 3; ++k) {
    const glm::vec3& p = positions[t[k]];
    corners[static_cast<std::size_t>(k)] = {bits(p.x), bits(p.y), bits(p.z)};
  }
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  Key key;
  for (std::size_t i = 0; i < 9; ++i) key[i] = corners[i / 3][i % 3];
  return key;
}

}  // namespace

bool restores(const Hierarchy& hierarchy, const TriangleMesh& mesh) {
  if (hierarchy.input_triangle_count() != mesh.triangle_count()) return false;
  std::vector<Key> restored, input;
  restored.reserve(mesh.triangle_count());
  input.reserve(mesh.triangle_count());
  for (const Triangle& t : triangles_of(hierarchy, full_cut(hierarchy)))
    restored.push_back(key_of(t, hierarchy.positions()));
  for (const Triangle& t : mesh.triangles) input.push_back(key_of(t, mesh.positions));
  std::sort(restored.begin(), restored.end());
  std::sort(input.begin(), input.end());
  return restored == input;
}

}  // namespace occlod
