// Builds a tree of boxes over triangles, to find those that a segment meets or a region contains.
#pragma once

#include <algorithm>
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

// Halves ranges at the median of the longest axis, with ties resolved by number, so the tree depends only on the
// triangles. It is built over triangles in any order and returns the order in which they must be stored: those below a
// node are consecutive.
class TriangleBvh {
 public:
  TriangleBvh() = default;
  // Builds the tree. `order` is resized and receives which triangle comes where. O(n log n).
  TriangleBvh(std::span<const glm::dvec3> positions, std::span<const Triangle> triangles,
              std::vector<std::uint32_t>& order);

  // Calls visit(triangle) for triangles that the segment meets, roughly from its start to its end, until it returns
  // false. Rounding may miss a triangle whose edge it passes. Takes the positions and triangles that were given to the
  // constructor, with the triangles in the order that it returned. Typically O(log n + hits).
  template <typename Visit>
  void for_each_hit(std::span<const glm::dvec3> positions, std::span<const Triangle> triangles, const glm::dvec3& from,
                    const glm::dvec3& to, const Visit& visit) const;

  // Calls visit(triangle), until it returns false, for all triangles of leaves whose boxes the segment meets; these
  // include every triangle that it meets.
  template <typename Visit>
  void for_each_near(const glm::dvec3& from, const glm::dvec3& to, const Visit& visit) const;

  // Returns whether the segment meets the triangle, up to rounding.
  [[nodiscard]] static bool meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& from,
                                  const glm::dvec3& along);

  // Holds some consecutive triangles and a box around them.
  struct Group {
    CellBox box;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  // Calls enter(group) for nodes, roughly from the nearest to the farthest from `eye`. Where it returns true, continues
  // below the node, down to groups of at most `most` triangles, for which it calls visit(group).
  template <typename Enter, typename Visit>
  void for_each_group(const glm::dvec3& eye, std::uint32_t most, const Enter& enter, const Visit& visit) const;

 private:
  static constexpr std::uint32_t leaf_size = 4;
  // Nodes over more triangles than a leaf have two children; the left one, over half of them rounded down, is the next
  // node.
  struct Node {
    std::array<float, 3> min{};  // rounded outwards
    std::uint32_t right = 0;     // index of the other child
    std::array<float, 3> max{};
    std::uint32_t axis = 0;  // along which the left child comes first
  };
  static_assert(sizeof(Node) == 32);
  struct Entry {
    std::uint32_t node = 0, first = 0, count = 0;
  };
  using Stack = std::array<Entry, 64>;  // deep enough for halving 2^32 triangles

  // `inverse` holds the reciprocals of the segment's direction, by axis. Where one is infinite, the product may be NaN,
  // which std::min and std::max then ignore.
  [[nodiscard]] static bool meets(const Node& node, const glm::dvec3& from, const glm::dvec3& inverse);
  // Pushes the children of the node, the one to visit first on top.
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

inline bool TriangleBvh::meets(const Node& node, const glm::dvec3& from, const glm::dvec3& inverse) {
  double first = 0.0, last = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const double a = (static_cast<double>(node.min[i]) - from[axis]) * inverse[axis];
    const double b = (static_cast<double>(node.max[i]) - from[axis]) * inverse[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  return first <= last + 1e-12;
}

inline void TriangleBvh::push_children(const Entry& entry, bool left_first, Stack& stack, std::size_t& size) const {
  const std::uint32_t half = entry.count / 2;
  const Entry left{entry.node + 1, entry.first, half};
  const Entry right{nodes_[entry.node].right, entry.first + half, entry.count - half};
  stack[size++] = left_first ? right : left;
  stack[size++] = left_first ? left : right;
}

// Holds the surfaces that hide geometry from cells: those of all objects in world space, original or coarser.

// Stores triangles, their adjacency over edges, and a tree over them, in whose order they are stored. Immutable. Of
// triangles with the same three corners only one is kept; degenerate triangles are left out.
class CellSurface {
 public:
  // Takes from each object the cut whose faces have moved by at most max_motion (world units); with 0 the input itself.
  CellSurface(std::span<const RefineObject> objects, double max_motion);
  // Takes given triangles, for tests. `moved` holds the motion of each in world units, or is empty.
  CellSurface(std::vector<glm::dvec3> positions, std::span<const Triangle> triangles, std::span<const float> moved);

  [[nodiscard]] std::uint32_t triangle_count() const noexcept { return static_cast<std::uint32_t>(triangles_.size()); }
  [[nodiscard]] const glm::dvec3& corner(std::uint32_t t, int k) const noexcept { return positions_[triangles_[t][k]]; }
  // Returns a bound on how far the part of the input that the triangle represents may be from it, world units.
  [[nodiscard]] double moved(std::uint32_t t) const noexcept { return moved_[t]; }

  // Returns the next edge between the same two corners, in a circle; a border edge returns itself. Edge 3 t + k runs
  // from corner k of triangle t to the next corner.
  [[nodiscard]] std::uint32_t beyond(std::uint32_t edge) const noexcept { return beyond_[edge]; }
  // Returns whether an odd number of triangles share the edge.
  [[nodiscard]] bool is_border(std::uint32_t edge) const noexcept { return is_border_[edge]; }

  // Calls visit(triangle) for triangles that the segment meets, until it returns false. See TriangleBvh.
  template <typename Visit>
  void for_each_hit(const glm::dvec3& from, const glm::dvec3& to, const Visit& visit) const {
    bvh_.for_each_hit(positions_, triangles_, from, to, visit);
  }
  // Returns whether the segment meets the triangle, up to rounding.
  [[nodiscard]] bool meets(std::uint32_t t, const glm::dvec3& from, const glm::dvec3& to) const {
    return TriangleBvh::meets(corner(t, 0), corner(t, 1), corner(t, 2), from, to - from);
  }
  [[nodiscard]] const TriangleBvh& bvh() const noexcept { return bvh_; }
  // Returns the largest absolute coordinate of any corner.
  [[nodiscard]] double largest_coordinate() const noexcept { return largest_coordinate_; }

 private:
  // Returns the cut for `max_motion`, in object units.
  [[nodiscard]] static MotionCut cut_of(const Hierarchy& hierarchy, double max_motion);
  // Adds a cut; `scale` converts motions from object to world units.
  void add(const RefineObject& object, const MotionCut& cut, double scale);
  void add_triangle(const Triangle& t, double moved);
  void finish();
  void drop_duplicates();
  // Sorts triangles into this order, and corners into the order of their first use, so that neighbours are near each
  // other in memory.
  void sort(std::span<const std::uint32_t> order);
  void join_edges();

  std::vector<glm::dvec3> positions_;
  std::vector<Triangle> triangles_;
  std::vector<float> moved_;  // per triangle, rounded up
  std::vector<std::uint32_t> beyond_;
  std::vector<bool> is_border_;
  double largest_coordinate_ = 0.0;
  TriangleBvh bvh_;
};

}  // namespace occlod
