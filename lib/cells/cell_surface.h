// A tree of boxes over triangles, to find those that a segment meets or a region holds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/base.h"
#include "occlod/cell_builder.h"
#include "occlod/mesh.h"
#include "occlod/refiner.h"
#include "splits/surface_motion.h"

namespace occlod {

// Halved at the median of the longest axis; ties by number, so the tree depends on the triangles only. It is built over
// triangles in any order and says in which they have to be kept: those below a node follow each other.
class TriangleBvh {
 public:
  TriangleBvh() = default;
  // `order`: resized; which triangle comes where. O(n log n).
  TriangleBvh(std::span<const glm::dvec3> positions, std::span<const Triangle> triangles,
              std::vector<std::uint32_t>& order);

  // Calls visit(triangle) for triangles that the segment meets, roughly from its start to its end, until it returns
  // false. Rounding may miss one whose edge it passes. The same positions and triangles as given to the constructor,
  // the triangles in the order that it gave. O(log n + hits) mostly.
  template <typename Visit>
  void for_each_hit(std::span<const glm::dvec3> positions, std::span<const Triangle> triangles, const glm::dvec3& from,
                    const glm::dvec3& to, const Visit& visit) const;

  // Calls visit(triangle), until it returns false, for triangles of leaves whose boxes the segment meets: none that it
  // meets is missed.
  template <typename Visit>
  void for_each_near(const glm::dvec3& from, const glm::dvec3& to, const Visit& visit) const;

  // Whether the segment meets the triangle, up to rounding.
  [[nodiscard]] static bool meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& from,
                                  const glm::dvec3& along);

  // Some triangles that follow each other, and a box around them.
  struct Group {
    CellBox box;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  // Calls enter(group) for nodes, roughly from the nearest to the farthest from `eye`. Below a node for which it
  // returns true it goes on, down to groups of no more than `most` triangles, for which it calls visit(group).
  template <typename Enter, typename Visit>
  void for_each_group(const glm::dvec3& eye, std::uint32_t most, const Enter& enter, const Visit& visit) const;

 private:
  static constexpr std::uint32_t leaf_size = 4;
  // Nodes over more triangles have two children: the left one, over half of them rounded down, is the next node.
  struct Node {
    std::array<float, 3> min{};  // rounded outwards
    std::uint32_t right = 0;     // the other child
    std::array<float, 3> max{};
    std::uint32_t axis = 0;  // in which the left child comes first
  };
  static_assert(sizeof(Node) == 32);
  struct Entry {
    std::uint32_t node = 0, first = 0, count = 0;
  };
  using Stack = std::array<Entry, 64>;  // halves of 2^32 triangles

  // `inverse`: of the segment's direction, by axis. Where that is infinite the product may be no number, which std::min
  // and std::max then pass over.
  [[nodiscard]] static bool meets(const Node& node, const glm::dvec3& from, const glm::dvec3& inverse);
  // The children of the node, the one to visit first on top.
  void push_children(const Entry& entry, bool left_first, Stack& stack, std::size_t& size) const;
  void build(std::span<const CellBox> boxes, std::span<std::uint32_t> order);

  std::vector<Node> nodes_;
  std::uint32_t count_ = 0;
};

template <typename Visit>
void TriangleBvh::for_each_hit(std::span<const glm::dvec3> positions, std::span<const Triangle> triangles,
                               const glm::dvec3& from, const glm::dvec3& to, const Visit& visit) const {
  const glm::dvec3 along = to - from;
  for_each_near(from, to, [&](std::uint32_t i) {
    const Triangle& t = triangles[i];
    return !meets(positions[t.x], positions[t.y], positions[t.z], from, along) || visit(i);
  });
}

template <typename Visit>
void TriangleBvh::for_each_near(const glm::dvec3& from, const glm::dvec3& to, const Visit& visit) const {
  if (nodes_.empty()) return;
  const glm::dvec3 along = to - from, inverse = 1.0 / along;
  Stack stack;
  std::size_t size = 0;
  stack[size++] = {0, 0, count_};
  while (size > 0) {
    const Entry entry = stack[--size];
    const Node& node = nodes_[entry.node];
    if (!meets(node, from, inverse)) continue;
    if (entry.count > leaf_size) {
      push_children(entry, along[static_cast<int>(node.axis)] >= 0.0, stack, size);
      continue;
    }
    for (std::uint32_t i = entry.first; i < entry.first + entry.count; ++i)
      if (!visit(i)) return;
  }
}

template <typename Enter, typename Visit>
void TriangleBvh::for_each_group(const glm::dvec3& eye, std::uint32_t most, const Enter& enter,
                                 const Visit& visit) const {
  if (nodes_.empty()) return;
  Stack stack;
  std::size_t size = 0;
  stack[size++] = {0, 0, count_};
  while (size > 0) {
    const Entry entry = stack[--size];
    const Node& node = nodes_[entry.node];
    const Group group{
        {glm::dvec3(node.min[0], node.min[1], node.min[2]), glm::dvec3(node.max[0], node.max[1], node.max[2])},
        entry.first,
        entry.count};
    if (!enter(group)) continue;
    if (entry.count <= most || entry.count <= leaf_size) {
      visit(group);
      continue;
    }
    const auto axis = static_cast<int>(node.axis);
    push_children(entry, 2.0 * eye[axis] <= group.box.min[axis] + group.box.max[axis], stack, size);
  }
}

inline void TriangleBvh::push_children(const Entry& entry, bool left_first, Stack& stack, std::size_t& size) const {
  const std::uint32_t half = entry.count / 2;
  const Entry left{entry.node + 1, entry.first, half};
  const Entry right{nodes_[entry.node].right, entry.first + half, entry.count - half};
  stack[size++] = left_first ? right : left;
  stack[size++] = left_first ? left : right;
}

// What hides from cells: the surfaces of all objects in world space, as they are or coarser.

// Triangles, what lies beyond their edges, and a tree over them, in whose order they are. Immutable. Of triangles with
// the same three corners one is kept; what has less than three corners is left out.
class CellSurface {
 public:
  // Of each object the cut whose faces have moved by no more than max_motion (world units); with 0 the input itself.
  CellSurface(std::span<const RefineObject> objects, double max_motion);
  // Of triangles given as they are, for tests. `moved`: of each, world units; or none.
  CellSurface(std::vector<glm::dvec3> positions, std::span<const Triangle> triangles, std::span<const float> moved);

  [[nodiscard]] std::uint32_t triangle_count() const noexcept { return static_cast<std::uint32_t>(triangles_.size()); }
  [[nodiscard]] const glm::dvec3& corner(std::uint32_t t, int k) const noexcept { return positions_[triangles_[t][k]]; }
  // How far the input that the triangle stands for may be from it, world units.
  [[nodiscard]] double moved(std::uint32_t t) const noexcept { return moved_[t]; }

  // Edge 3 t + k runs from corner k of triangle t to the next. The next one of those between the same corners, in a
  // circle: itself at a border.
  [[nodiscard]] std::uint32_t beyond(std::uint32_t edge) const noexcept { return beyond_[edge]; }
  // Whether an odd number of triangles share it.
  [[nodiscard]] bool is_border(std::uint32_t edge) const noexcept { return is_border_[edge]; }

  // Calls visit(triangle) for triangles that the segment meets, until it returns false. See TriangleBvh.
  template <typename Visit>
  void for_each_hit(const glm::dvec3& from, const glm::dvec3& to, const Visit& visit) const {
    bvh_.for_each_hit(positions_, triangles_, from, to, visit);
  }
  // Whether the segment meets the triangle, up to rounding.
  [[nodiscard]] bool meets(std::uint32_t t, const glm::dvec3& from, const glm::dvec3& to) const {
    return TriangleBvh::meets(corner(t, 0), corner(t, 1), corner(t, 2), from, to - from);
  }
  [[nodiscard]] const TriangleBvh& bvh() const noexcept { return bvh_; }
  // The largest coordinate of any corner.
  [[nodiscard]] double largest_coordinate() const noexcept { return largest_coordinate_; }

 private:
  // `max_motion`: object units.
  [[nodiscard]] static MotionCut cut_of(const Hierarchy& hierarchy, double max_motion);
  // `scale`: of motions, from object to world.
  void add(const RefineObject& object, const MotionCut& cut, double scale);
  void add_triangle(const Triangle& t, double moved);
  void finish();
  void drop_duplicates();
  // Triangles in this order, corners in that in which they ask for them: neighbours lie near each other in memory.
  void sort(std::span<const std::uint32_t> order);
  void join_edges();

  std::vector<glm::dvec3> positions_;
  std::vector<Triangle> triangles_;
  std::vector<float> moved_;  // of triangles, rounded up
  std::vector<std::uint32_t> beyond_;
  std::vector<bool> is_border_;
  double largest_coordinate_ = 0.0;
  TriangleBvh bvh_;
};

}  // namespace occlod
