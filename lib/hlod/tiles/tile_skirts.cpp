#include <glm/geometric.hpp>

#include "occlod/core/ids.h"
#include "hlod/tiles/border_edges.h"
#include "hlod/tiles/tile_mesh.h"

namespace occlod::tiles {
namespace {

class SkirtMaker {
 public:
  SkirtMaker(TileMesh& tile, double depth)
      : tile_(tile),
        mesh_(tile.mesh),
        depth_(depth),
        first_(first_at_position(mesh_.positions)),
        areas_(area_sums(mesh_.positions, mesh_.triangles, first_)),
        hem_(mesh_.positions.size(), no_id) {}

  void run(const BorderVertices& borders) {
    const auto is_inputs = [&](VertexId v) {
      const BorderVertex* border = borders.at(mesh_.positions[v]);
      return border != nullptr && border->is_at_input_border;
    };
    for (const BorderEdge& edge : border_edges(mesh_.triangles, first_)) {
      if (is_inputs(edge.from) && is_inputs(edge.to)) continue;
      const VertexId from = hem(edge.from), to = hem(edge.to);
      // Wound like a neighbour across the edge, so that it faces away from the tile.
      mesh_.triangles.emplace_back(edge.to, edge.from, from);
      mesh_.triangles.emplace_back(edge.to, from, to);
      tile_.skirt_triangles += 2;
      if (!mesh_.triangle_materials.empty())
        mesh_.triangle_materials.insert(mesh_.triangle_materials.end(), 2, mesh_.triangle_materials[edge.triangle]);
    }
  }

 private:
  // The vertex below v, with its attributes.
  VertexId hem(VertexId v) {
    if (hem_[v] != no_id) return hem_[v];
    hem_[v] = static_cast<VertexId>(mesh_.positions.size());
    const glm::dvec3 area = areas_[first_[v]];
    const double length = glm::length(area);
    const glm::dvec3 inwards = length > 0.0 ? -area / length : glm::dvec3(0.0);
    mesh_.positions.emplace_back(glm::dvec3(mesh_.positions[v]) + depth_ * inwards);
    repeat(mesh_.normals, v);
    repeat(mesh_.colors, v);
    repeat(mesh_.texture_coordinates, v);
    return hem_[v];
  }

  template <typename T>
  static void repeat(std::vector<T>& attributes, VertexId v) {
    if (attributes.empty()) return;
    const T attribute = attributes[v];
    attributes.push_back(attribute);
  }

  TileMesh& tile_;
  TriangleMesh& mesh_;
  double depth_;
  std::vector<std::uint32_t> first_;
  std::vector<glm::dvec3> areas_;
  std::vector<VertexId> hem_;  // by vertex of the node: the one below it
};

}  // namespace

void add_skirts(TileMesh& tile, double depth, const BorderVertices& borders) { SkirtMaker(tile, depth).run(borders); }

}  // namespace occlod::tiles
