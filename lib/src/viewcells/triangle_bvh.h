// A tree of boxes over triangles, to find those that a segment meets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/mesh/triangle_mesh.h"
#include "occlod/viewcells/cell_view.h"

namespace occlod {

// Halved at the median of the longest axis; ties by number, so the tree depends on the triangles only.
class TriangleBvh {
 public:
  TriangleBvh() = default;
  // O(n log n).
  TriangleBvh(std::span<const glm::dvec3> positions, std::span<const Triangle> triangles);

  // Calls visit(triangle) for triangles that the segment meets, in the order of the tree, until it returns false.
  // Rounding may miss one whose edge it passes. The same positions and triangles as given to the constructor.
  // O(log n + hits) mostly.
  template <typename Visit>
  void for_each_hit(std::span<const glm::dvec3> positions, std::span<const Triangle> triangles, const glm::dvec3& from,
                    const glm::dvec3& to, const Visit& visit) const;

 private:
  static constexpr std::uint32_t leaf_size = 4;
  struct Node {
    CellBox box;
    std::uint32_t first = 0;  // of its triangles in order_
    std::uint32_t count = 0;  // 0: an inner node
    std::uint32_t right = 0;  // of an inner node; the left child is the next node
  };
  // `inverse`: of the segment's direction, by axis. Where that is infinite the product may be no number, which std::min
  // and std::max then pass over.
  [[nodiscard]] static bool meets(const CellBox& box, const glm::dvec3& from, const glm::dvec3& inverse);
  [[nodiscard]] static bool meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& from,
                                  const glm::dvec3& along);
  void build(std::span<const CellBox> boxes, std::uint32_t first, std::uint32_t count);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

template <typename Visit>
void TriangleBvh::for_each_hit(std::span<const glm::dvec3> positions, std::span<const Triangle> triangles,
                               const glm::dvec3& from, const glm::dvec3& to, const Visit& visit) const {
  if (nodes_.empty()) return;
  const glm::dvec3 along = to - from, inverse = 1.0 / along;
  std::array<std::uint32_t, 64> stack;  // halves of 2^32 triangles
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const std::uint32_t n = stack[--size];
    const Node& node = nodes_[n];
    if (!meets(node.box, from, inverse)) continue;
    if (node.count == 0) {
      stack[size++] = node.right;
      stack[size++] = n + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Triangle& t = triangles[order_[i]];
      if (meets(positions[t.x], positions[t.y], positions[t.z], from, along) && !visit(order_[i])) return;
    }
  }
}

}  // namespace occlod
