// Holds the data that all threads share while they simplify one mesh.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "base/memory.h"
#include "splits/attribute_state.h"
#include "splits/build_progress.h"
#include "splits/fan.h"
#include "splits/positions.h"
#include "splits/star_mesh.h"

namespace occlod {

// Holds the fields of a vertex that are read together. All lengths are in the state's scale.
struct alignas(64) VertexState {
  glm::vec3 position;
  float cost;           // of the cheapest collapse; a lower bound until checked; infinite without faces
  std::uint32_t place;  // index in the order of the current pass
  VertexQuadric quadric;
};
static_assert(sizeof(VertexState) == 64, "one cache line");

// Holds what is recorded of a vertex that has been in the ring of collapses.
struct VertexRecord {
  float error = 0.0F;  // distance of the worst face at the vertex from the input, in the state's scale
  float rank = 0.0F;   // the largest of any of these collapses
};

// Configures a SimplifyState.
struct SimplifySetup {
  double boundary_weight = 1.0;
  unsigned threads = 1;
  float scale = 0.0F;  // a power of two; 0: the one that scales the extent of the input into [1/2, 1]
  std::span<const std::uint8_t> locked{};  // per vertex: nonzero = never merged into another; empty = none locked
  bool keeps_attributes = false;           // if the mesh has any that count; the mesh must then outlive the state
  double attribute_weight = 1.0;           // weight of attribute deviations, relative to distances
  bool keeps_wedge_merges = false;         // whether BlockRecord::wedge_merges is wanted
  bool keeps_collapses = true;             // false: of each collapse, only BlockRecord::merges is wanted
};

// Holds per-vertex data. A worker accesses only vertices of its block and reads only their stars.
struct SimplifyState {
  SimplifyState(const TriangleMesh& input, const SimplifySetup& setup, const ProgressPart& progress);

  float scale = 1.0F;  // a power of two, so that scaling is exact
  std::span<const std::uint8_t> locked;
  UninitializedVector<VertexState> vertices;
  StarMesh mesh;
  LargeVector<VertexRecord> records;
  std::unique_ptr<AttributeState> attributes;  // null: attributes do not count
  float attribute_weight2 = 1.0F;              // weight of squared deviations
  bool keeps_wedge_merges = false;
  bool keeps_collapses = true;

  [[nodiscard]] PositionView positions() const {
    return {std::span<const VertexState>(vertices), &VertexState::position};
  }
  [[nodiscard]] auto position_of() const {
    return [first = vertices.data()](VertexId v) -> const glm::vec3& { return first[v].position; };
  }
  [[nodiscard]] glm::vec3 edge(VertexId v, VertexId u) const { return vertices[u].position - vertices[v].position; }
  // Returns whether the vertex is locked; a locked vertex has infinite cost.
  [[nodiscard]] bool is_locked(VertexId v) const { return !locked.empty() && locked[v] != 0; }
  [[nodiscard]] float cost(VertexId v, VertexId u) const { return vertices[v].quadric.cost(edge(v, u)); }
  // Returns the cost of v's cheapest collapse without checking the collapse.
  [[nodiscard]] float propose(VertexId v, Fan& fan) const;
  // Adds the plane of a face of the input, weighted by its area, to the quadric of any vertex.
  void add_plane_of(const Triangle& face, VertexId v);

 private:
  void make_quadric(VertexId v, Fan& fan, double boundary_weight);
  void hold_edges(VertexId v, double boundary_weight);
  void hold_seams(VertexId v);
};

}  // namespace occlod
