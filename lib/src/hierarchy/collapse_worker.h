// Greedy simplification of one block of vertices, as far as a threshold of cost.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "change_bound.h"
#include "collapse_queue.h"
#include "collapse_rules.h"
#include "fan.h"
#include "simplify.h"
#include "simplify_state.h"

namespace occlod {

struct BlockRecord {
  std::vector<Collapse> collapses;  // first_ended counts from this record's own `ended`
  std::vector<float> ranks;         // of each collapse: its cost, no less than that of any that it comes after
  std::vector<LevelFace> ended;
  std::size_t faces_gone = 0;
};

struct Block {
  std::span<const VertexId> vertices;
  std::uint32_t first_turn = 0;  // theirs ascend from here
  CollapseId first_id = 0;       // for its collapses
  float threshold = 0.0F;        // collapses that cost no more are made, cheapest first
  std::size_t stop_after = 0;    // ends early when so many faces have gone
};

class CollapseWorker {
 public:
  explicit CollapseWorker(SimplifyState& state) : state_(state) {}
  // Vertices whose ring leaves the block are left alone. Now and then it calls go_on(faces gone) and ends when the
  // answer is no. The record is valid until the next run.
  template <typename GoOn>
  const BlockRecord& run(const Block& block, const GoOn& go_on) {
    start(block);
    while (go_on(record_.faces_gone) && take_steps()) continue;
    return record_;
  }

 private:
  struct Choice {
    VertexId u = no_id;
    float cost = 0.0F;
    bool keeps_topology = false;
    std::size_t place = 0;  // of u in the ring
  };

  void start(const Block& block);
  bool take_steps();
  void prefetch_next() const;
  void set_cost(VertexId v, float cost);
  void consider(VertexId v);
  [[nodiscard]] bool in_block(std::span<const VertexId> vertices) const;
  [[nodiscard]] Choice choose_in_fan();
  [[nodiscard]] Choice choose_in_ring();
  [[nodiscard]] Choice break_topology(std::span<const VertexId> neighbours, VertexId v) const;
  [[nodiscard]] float movement(const Choice& choice, bool is_fan);
  void collapse(VertexId v, const Choice& choice, std::span<const VertexId> ring, float moved);
  float pass_on_errors(const Choice& choice, VertexId v, std::span<const VertexId> ring, float moved);
  void rank(VertexId v, const Choice& choice, std::span<const VertexId> ring);
  void update(VertexId w, VertexId u);
  [[nodiscard]] float longest_edge(std::span<const LevelFace> faces) const;

  SimplifyState& state_;
  StarArena arena_;
  CollapseQueue queue_;
  Fan fan_;
  Fan fan_of_u_;
  VertexRing ring_;
  ChangeBound change_bound_;
  const Block* block_ = nullptr;
  BlockRecord record_;
};

}  // namespace occlod
