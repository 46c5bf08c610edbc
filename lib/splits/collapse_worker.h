// A queue of vertices by the cost of their collapses, exact to some per cent.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "splits/attribute_star.h"
#include "splits/collapse_rules.h"
#include "splits/fan.h"
#include "splits/simplify.h"
#include "splits/simplify_state.h"

namespace occlod {

// Items are small numbers, each there at most once. Costs fall into levels of 1/32 octave; within a level the last to
// come is the first to go. Every operation takes constant time, but for the search of the next level that is not empty.
class CollapseQueue {
 public:
  // Empties the queue, for items in [0, count).
  void reset(std::size_t count) {
    links_.assign(count, {});
    heads_.fill(none);
    cursor_ = level_count;
  }

  [[nodiscard]] static std::uint32_t level(float cost) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(cost) >> 18;
    return std::clamp(bits, lowest_bits, highest_bits) - lowest_bits;
  }

  // The item is not in the queue. cost >= 0.
  void push(std::uint32_t item, float cost) {
    const std::uint32_t at = level(cost);
    links_[item] = {none, heads_[at], at};
    if (heads_[at] != none) links_[heads_[at]].before = item;
    heads_[at] = item;
    cursor_ = std::min(cursor_, at);
  }

  void remove(std::uint32_t item) {
    Link& link = links_[item];
    if (link.level == none) return;
    (link.before == none ? heads_[link.level] : links_[link.before].after) = link.after;
    if (link.after != none) links_[link.after].before = link.before;
    link.level = none;
  }

  // The cheapest item, or `none` when there is none; it leaves the queue.
  std::uint32_t pop() {
    while (cursor_ < level_count && heads_[cursor_] == none) ++cursor_;
    if (cursor_ >= level_count) return none;
    const std::uint32_t item = heads_[cursor_];
    remove(item);
    return item;
  }

  // Most likely the next item to pop; `none` when unknown.
  [[nodiscard]] std::uint32_t likely_next() const { return cursor_ < level_count ? heads_[cursor_] : none; }
  // Most likely the one to pop after that item.
  [[nodiscard]] std::uint32_t likely_after(std::uint32_t item) const { return links_[item].after; }

  static constexpr std::uint32_t none = UINT32_MAX;

 private:
  struct Link {
    std::uint32_t before = none, after = none;  // in the same level
    std::uint32_t level = none;                 // none: not in the queue
  };
  static constexpr std::uint32_t lowest_bits = (127U - 80U) << 5, highest_bits = (127U + 8U) << 5;  // 2^-80 to 2^8
  static constexpr std::uint32_t level_count = highest_bits - lowest_bits + 1;

  std::vector<Link> links_;
  std::array<std::uint32_t, level_count> heads_{};
  std::uint32_t cursor_ = level_count;
};

// What blocks record of their collapses, found again by the ids of these.

struct BlockRecord {
  std::vector<Collapse*> collapses;
  std::vector<float> ranks;  // of each collapse: its cost, no less than that of any that it comes after
  std::vector<MisplacedFace> misplaced;
  // Where attributes count, of each collapse: how far they are off, and where the wedges of what it ended begin.
  std::vector<float> attribute_errors;
  std::vector<std::size_t> first_corners;
  std::vector<EndedCorners> corners;
  std::vector<AttributeStar::WedgeMerge> wedge_merges;  // of all collapses, in their order, where they are wanted
  std::size_t faces_gone = 0;
};

// The ids of a block's collapses ascend from a multiple of block_size: only the last block may have more of them.
// Blocks that run at the same time may add collapses, each to its own record.
class CollapseRecords {
 public:
  static constexpr std::size_t block_size = 8192;

  void resize(std::size_t blocks) { records_.resize(blocks); }
  [[nodiscard]] std::size_t size() const noexcept { return records_.size(); }
  [[nodiscard]] BlockRecord& operator[](std::size_t block) noexcept { return records_[block]; }
  [[nodiscard]] const BlockRecord& operator[](std::size_t block) const noexcept { return records_[block]; }
  [[nodiscard]] static CollapseId first_id(std::size_t block) noexcept {
    return static_cast<CollapseId>(block * block_size);
  }
  // No id is larger.
  [[nodiscard]] std::size_t end_id() const noexcept {
    return records_.empty() ? 0 : first_id(size() - 1) + records_.back().collapses.size();
  }
  [[nodiscard]] Collapse* const& collapse(CollapseId id) const noexcept {
    const std::size_t block = std::min(id / block_size, size() - 1);
    return records_[block].collapses[id - first_id(block)];
  }
  // Adds one to the record of this block, which ended faces of these makers. The faces in whose place those were made
  // learn of it.
  void add(std::size_t block, Collapse& collapse, std::span<const LevelFace> ended);

 private:
  std::vector<BlockRecord> records_;
};

// The shape of the faces that one collapse of v ended, brought into ring order if they are one fan.
[[nodiscard]] StarShape shape_of(VertexId v, std::span<LevelFace> faces);

// Greedy simplification of one block of vertices, as far as a threshold of cost.

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
  std::array<Batch, Fan::max_neighbours + 1> batches_;  // by the number of corners
  CollapseRecords& records_;
  CollapseMemory memory_;
};

}  // namespace occlod
