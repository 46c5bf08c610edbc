// Greedy simplification of one block of vertices, as far as a threshold of cost.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "change_bound.h"
#include "collapse_rules.h"
#include "fan.h"
#include "simplify.h"
#include "star_mesh.h"
#include "vertex_quadric.h"

namespace occlod {

// What all workers share. A worker touches only vertices of its block, faces with all corners in it, and reads faces at
// those vertices.
struct SimplifyState {
  SimplifyState(const TriangleMesh& input, double boundary_weight);

  std::span<const glm::vec3> positions;
  float unit = 1.0F;  // 1 / extent of the mesh: quadrics and costs are in a mesh of size 1
  StarMesh mesh;
  std::vector<VertexQuadric> quadrics;
  std::vector<std::uint8_t> plain;      // the star of v is one closed fan, as far as is known
  std::vector<float> costs;             // of v's cheapest collapse: mean square error; a lower bound until checked
  std::vector<VertexId> targets;        // where that collapse goes
  std::vector<std::uint32_t> block_of;  // of each vertex, in the pass that runs
  std::vector<CollapseId> made_by;      // the collapse that gave the face slot its corners
  std::vector<float> face_errors;       // distance of the face from the input, object units

  [[nodiscard]] float cost(VertexId v, VertexId u) const;
  // Finds v's cheapest collapse, unchecked.
  void propose(VertexId v);

 private:
  void make_quadrics(double boundary_weight);
  void hold_edges(VertexId v, double boundary_weight);
};

struct BlockRecord {
  std::vector<Collapse> collapses;  // first_ended counts from this record's own `ended`
  std::vector<LevelFace> ended;
  std::size_t faces_gone = 0;
};

struct Block {
  std::span<const VertexId> vertices;
  std::uint32_t number = 0;    // what block_of says of them
  CollapseId first_id = 0;     // for its collapses
  float threshold = 0.0F;      // collapses that cost no more are made, cheapest first
  std::size_t stop_after = 0;  // ends early when so many faces have gone
};

class CollapseWorker {
 public:
  explicit CollapseWorker(SimplifyState& state) : state_(state) {}
  // Vertices whose ring leaves the block are left alone.
  void run(const Block& block, BlockRecord& record);

 private:
  struct Candidate {
    float cost;
    VertexId v;
    // Heaps pop the largest: the cheapest, ties by id.
    bool operator<(const Candidate& o) const { return cost != o.cost ? cost > o.cost : v > o.v; }
  };
  struct Choice {
    VertexId u = no_id;
    float cost = 0.0F;
    float moved = 0.0F;  // bound on how far the surface moves, object units
    bool keeps_topology = false;
  };

  void push(VertexId v);
  void consider(const Candidate& candidate);
  [[nodiscard]] bool in_block(std::span<const VertexId> vertices) const;
  [[nodiscard]] Choice choose_in_fan();
  [[nodiscard]] Choice choose_in_ring();
  [[nodiscard]] Choice break_topology(std::span<const VertexId> neighbours, VertexId v) const;
  void collapse(VertexId v, const Choice& choice, std::span<const VertexId> ring);
  void update(VertexId w, VertexId v, VertexId u);
  [[nodiscard]] float longest_edge(const Triangle& t) const;

  SimplifyState& state_;
  StarArena arena_;
  std::vector<Candidate> heap_;
  Fan fan_;
  VertexRing ring_;
  ChangeBound change_bound_;
  const Block* block_ = nullptr;
  BlockRecord* record_ = nullptr;
};

}  // namespace occlod
