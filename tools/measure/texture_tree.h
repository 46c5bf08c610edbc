// Finds triangles by their places in space and in the texture at once.
#pragma once

#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::measure {

// Holds a box in space and one in the texture, around the same triangles.
struct TextureBox {
  glm::dvec3 low, high;
  glm::dvec2 texture_low, texture_high;

  // Returns the distance from a point to the box; 0 inside.
  [[nodiscard]] double distance(const glm::dvec3& p) const {
    return glm::length(glm::max(glm::max(low - p, p - high), glm::dvec3(0.0)));
  }
  [[nodiscard]] double texture_distance(const glm::dvec2& t) const {
    return glm::length(glm::max(glm::max(texture_low - t, t - texture_high), glm::dvec2(0.0)));
  }
};

// Holds a tree of boxes over some triangles of a mesh.
class TextureTree {
 public:
  // `triangles` lists at least one triangle of the mesh, whose missing texture coordinates count as 0. `texture_scale`
  // is the number of object units that weigh as much as one unit of the texture. O(n log n) time, about 90 bytes per
  // triangle.
  TextureTree(const TriangleMesh& mesh, std::vector<std::uint32_t> triangles, double texture_scale);

  // Calls visit_triangle(triangle) for those in boxes whose cost(box) is below bound(), the cheaper of two boxes first.
  // A box around another must not cost more. A visit may lower the bound.
  template <typename Cost, typename Bound, typename Visit>
  void visit(const Cost& cost, const Bound& bound, const Visit& visit_triangle) const {
    std::array<Step, 64> open;  // the tree is no deeper than 32 halvings
    std::size_t size = 0;
    open[size++] = {0, cost(nodes_[0].box)};
    while (size > 0) {
      const Step step = open[--size];
      if (!(step.cost < bound())) continue;
      const Node& node = nodes_[step.node];
      if (node.count > 0) {
        for (std::uint32_t i = 0; i < node.count; ++i) visit_triangle(triangles_[node.first + i]);
        continue;
      }
      const Step near{node.first, cost(nodes_[node.first].box)}, far{node.second, cost(nodes_[node.second].box)};
      const bool in_order = near.cost <= far.cost;
      open[size++] = in_order ? far : near;
      open[size++] = in_order ? near : far;
    }
  }

 private:
  struct Node {
    TextureBox box;
    std::uint32_t first;   // child, or into triangles_
    std::uint32_t second;  // child
    std::uint32_t count;   // number of triangles; 0: two children
  };
  struct Step {
    std::uint32_t node;
    double cost;
  };
  class Builder;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace occlod::measure
