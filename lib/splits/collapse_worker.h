// Greedy simplification of one block of vertices, as far as a threshold of cost.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "splits/attribute_star.h"
#include "splits/change_bound.h"
#include "splits/collapse_queue.h"
#include "splits/collapse_records.h"
#include "splits/collapse_rules.h"
#include "splits/fan.h"
#include "splits/fan_movements.h"
#include "splits/simplify.h"
#include "splits/simplify_state.h"

namespace occlod {

struct Block {
  std::span<const VertexId> vertices;
  std::uint32_t first_turn = 0;  // theirs ascend from here
  std::size_t record = 0;        // where its collapses are recorded
  float threshold = 0.0F;        // collapses that cost no more are made, cheapest first
  std::size_t stop_after = 0;    // ends early when so many faces have gone
};

class CollapseWorker {
 public:
  CollapseWorker(SimplifyState& state, CollapseRecords& records) : state_(state), records_(records) {}
  // Vertices whose ring leaves the block are left alone. Now and then it calls go_on(faces gone) and ends when the
  // answer is no.
  template <typename GoOn>
  void run(const Block& block, const GoOn& go_on) {
    start(block);
    while (go_on(faces_gone_) && take_steps()) continue;
    finish();
  }
  // The memory of what has been recorded.
  [[nodiscard]] CollapseMemory take_memory() { return std::move(memory_); }

 private:
  struct Choice {
    VertexId u = no_id;
    float cost = 0.0F;
    bool keeps_topology = false;
    std::size_t place = 0;  // of u in the ring
  };

  // A collapse that has been made, but for what does not decide about others.
  struct Made {
    VertexId v = no_id, u = no_id;
    std::size_t first_ended = 0;  // into ended_
    float error = 0.0F;
    float moved = 0.0F;  // of a fan: once its batch has been computed
    bool keeps_topology = false;
    float attribute_error = 0.0F;
    std::size_t first_corners = 0;  // into corners_
  };
  // A face that ended, and the wedges at its corners.
  struct CornerFace {
    LevelFace face;
    Triangle wedges;
  };
  // Fans of one size whose movements are computed together, and their places in made_.
  struct Batch {
    FanMovements fans;
    FanMovements::PerFan<std::size_t> made;
  };

  void start(const Block& block);
  void finish();
  [[nodiscard]] std::span<LevelFace> ended_by(std::size_t i);
  void prefetch_makers(std::size_t i);
  bool take_steps();
  void prefetch_next() const;
  void set_cost(VertexId v, float cost);
  void consider(VertexId v);
  [[nodiscard]] bool in_block(std::span<const VertexId> vertices) const;
  [[nodiscard]] Choice choose_in_fan();
  [[nodiscard]] Choice choose_in_ring();
  [[nodiscard]] Choice choose_with_attributes(std::span<const VertexId> ring, bool is_fan);
  [[nodiscard]] float add_deviation(VertexId v, float deviation2);
  void record_corners(std::size_t i, std::span<const LevelFace> ended, BlockRecord& record);
  void move_corners(VertexId v, VertexId u, CollapseId id, std::size_t first_ended);
  [[nodiscard]] Choice break_topology(std::span<const VertexId> neighbours, VertexId v) const;
  [[nodiscard]] float movement(const Choice& choice, bool is_fan);
  void compute_movements(Batch& batch);
  void collapse(VertexId v, const Choice& choice, std::span<const VertexId> ring, float moved);
  float pass_on_errors(const Made& made, std::span<const LevelFace> ended);
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
  std::vector<Made> made_;
  std::vector<float> ranks_;
  std::vector<LevelFace> ended_;
  AttributeStar attributes_;
  std::vector<CornerFace> corners_;  // of faces that ended, where some wedge is not its vertex's first
  std::vector<AttributeStar::WedgeMerge> wedge_merges_;
  std::vector<bool> taken_;
  std::vector<float> ring_costs_;
  std::vector<StarFace> folded_;
  std::size_t faces_gone_ = 0;
  std::array<Batch, Fan::most_neighbours + 1> batches_;  // by the number of corners
  CollapseRecords& records_;
  CollapseMemory memory_;
};

}  // namespace occlod
