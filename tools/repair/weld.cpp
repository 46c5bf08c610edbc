#include "repair/weld.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_map>

#include "repair/array_hash.h"

namespace occlod::repair {
namespace {

// Holds kept vertices in cubes as wide as the distance, so that all within it lie in one of 27 cubes. Cubes are
// numbered by whole doubles. Where numbers are too large to differ from their neighbours', floats are farther apart
// than the distance.
class Grid {
 public:
  Grid(const TriangleMesh& mesh, double distance) : mesh_(mesh), distance_(distance) {}

  void add(VertexId v) { cells_[cell_of(v)].push_back(v); }

  [[nodiscard]] VertexId nearest(VertexId v) const {
    const Cell center = cell_of(v);
    const glm::dvec3 p(mesh_.positions[v]);
    VertexId best = no_id;
    double best_distance = distance_;
    for (int i = 0; i < 27; ++i) {
      const int x = i % 3 - 1, y = i / 3 % 3 - 1, z = i / 9 - 1;
      const auto found = cells_.find({center[0] + x, center[1] + y, center[2] + z});
      if (found == cells_.end()) continue;
      for (const VertexId w : found->second) {
        const double distance = glm::distance(p, glm::dvec3(mesh_.positions[w]));
        if (distance < best_distance || (distance == best_distance && w < best)) best = w, best_distance = distance;
      }
    }
    return best;
  }

 private:
  using Cell = std::array<double, 3>;

  [[nodiscard]] Cell cell_of(VertexId v) const {
    const glm::dvec3 p = glm::dvec3(mesh_.positions[v]) / distance_;
    return {std::floor(p.x), std::floor(p.y), std::floor(p.z)};
  }

  const TriangleMesh& mesh_;
  double distance_;
  std::unordered_map<Cell, std::vector<VertexId>, ArrayHash<Cell>> cells_;
};

}  // namespace

std::vector<VertexId> weld_targets(const TriangleMesh& mesh, double distance) {
  Grid kept(mesh, distance);
  std::vector<VertexId> targets(mesh.vertex_count());
  for (VertexId v = 0; v < targets.size(); ++v) {
    const VertexId near = kept.nearest(v);
    targets[v] = near == no_id ? v : near;
    if (near == no_id) kept.add(v);
  }
  return targets;
}

}  // namespace occlod::repair
