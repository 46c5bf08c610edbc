// What all threads share while they simplify one mesh.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "fan.h"
#include "star_mesh.h"
#include "vertex_quadric.h"

namespace occlod {

// Indexed by vertex. A worker touches only vertices of its block and reads stars of those.
struct SimplifyState {
  SimplifyState(const TriangleMesh& input, double boundary_weight, unsigned threads);

  float scale = 1.0F;                // a power of two: scaling is exact
  std::vector<glm::vec3> positions;  // the input's x scale: an extent in [1/2, 1]. All lengths here are of this scale
  StarMesh mesh;
  std::vector<VertexQuadric> quadrics;
  std::vector<float> costs;          // of the cheapest collapse; a lower bound until checked; infinite without faces
  std::vector<float> errors;         // distance of the worst face at the vertex from the input
  std::vector<std::uint32_t> ranks;  // the vertex's place in the order of the pass that runs

  [[nodiscard]] float cost(VertexId v, VertexId u) const { return quadrics[v].cost(positions[u] - positions[v]); }
  // The cost of v's cheapest collapse, unchecked.
  [[nodiscard]] float propose(VertexId v, Fan& fan) const;
  // Hints that all of v will soon be used.
  void prefetch(VertexId v) const {
    __builtin_prefetch(&positions[v]);
    __builtin_prefetch(&quadrics[v]);
    __builtin_prefetch(&costs[v]);
    __builtin_prefetch(&errors[v]);
    __builtin_prefetch(&ranks[v]);
    mesh.prefetch(v);
  }

 private:
  void make_quadric(VertexId v, Fan& fan, double boundary_weight);
  void hold_edges(VertexId v, double boundary_weight);
};

}  // namespace occlod
