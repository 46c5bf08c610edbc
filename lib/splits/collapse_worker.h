// A queue of vertices by the cost of their collapses, exact to a few per cent.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "splits/attribute_state.h"
#include "splits/collapse_rules.h"
#include "splits/fan.h"
#include "splits/simplify.h"
#include "splits/simplify_state.h"

namespace occlod {

// Items are small numbers, each queued at most once. Costs are grouped into levels of 1/32 octave; within a level the
// last item pushed is popped first. Every operation takes constant time, except for the search for the next level that
// is not empty.
class CollapseQueue {
 public:
  // Empties the queue and prepares it for items in [0, count).
  void reset(std::size_t count) {
    links_.assign(count, {});
    heads_.fill(none);
    cursor_ = level_count;
  }

  [[nodiscard]] static std::uint32_t level(float cost) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(cost) >> 18;
    return std::clamp(bits, lowest_bits, highest_bits) - lowest_bits;
  }

  // Adds an item that is not in the queue. cost >= 0.
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

  // Removes and returns the cheapest item, or `none` when the queue is empty.
  std::uint32_t pop() {
    while (cursor_ < level_count && heads_[cursor_] == none) ++cursor_;
    if (cursor_ >= level_count) return none;
    const std::uint32_t item = heads_[cursor_];
    remove(item);
    return item;
  }

  // Returns the item that will probably be popped next; `none` when unknown.
  [[nodiscard]] std::uint32_t likely_next() const { return cursor_ < level_count ? heads_[cursor_] : none; }
  // Returns the item that will probably be popped after the given one.
  [[nodiscard]] std::uint32_t likely_after(std::uint32_t item) const { return links_[item].after; }

  static constexpr std::uint32_t none = UINT32_MAX;

 private:
  struct Link {
    std::uint32_t before = none, after = none;  // neighbours in the same level
    std::uint32_t level = none;                 // none: not queued
  };
  static constexpr std::uint32_t lowest_bits = (127U - 80U) << 5, highest_bits = (127U + 8U) << 5;  // 2^-80 to 2^8
  static constexpr std::uint32_t level_count = highest_bits - lowest_bits + 1;

  std::vector<Link> links_;
  std::array<std::uint32_t, level_count> heads_{};
  std::uint32_t cursor_ = level_count;
};

// Stores the collapses that blocks record, which can be found by their ids.

// Records that v was merged into u.
struct VertexMerge {
  VertexId v = no_id, u = no_id;
};

struct BlockRecord {
  std::vector<VertexMerge> merges;  // in order, instead of all else but faces_gone, where collapses are not wanted
  std::vector<float> ranks;         // per collapse: its cost, at least that of any collapse it depends on
  std::vector<MisplacedFace> misplaced;
  // Per collapse, where attributes count: its attribute error, and where the wedges of the faces that it ended begin.
  std::vector<float> attribute_errors;
  std::vector<std::size_t> first_corners;
  std::vector<EndedCorners> corners;
  std::vector<AttributeStar::WedgeMerge> wedge_merges;  // of all collapses, in order, if requested
  std::size_t faces_gone = 0;
  std::size_t last_gone = 0;  // by the last collapse
  // Where collapses are not wanted: the largest cost of one, and its largest error, object units: quadric error or that
  // of attributes.
  float largest_cost = 0.0F, largest_error = 0.0F;
  float torn = 0.0F;  // where they are: the largest error of one that changed the topology, object units
};

// The ids of a block's collapses ascend from a multiple of block_size; only the last block may have more than
// block_size. Blocks that run at the same time may add collapses, each to its own record.
class CollapseRecords {
 public:
  static constexpr std::size_t block_size = 8192;

  // Makes room for so many blocks, the last of them with at most this many collapses.
  void resize(std::size_t blocks, std::size_t last_size) {
    records_.resize(blocks);
    collapses_.resize(blocks == 0 ? 0 : first_id(blocks - 1) + last_size);
  }
  [[nodiscard]] std::size_t size() const noexcept { return records_.size(); }
  [[nodiscard]] BlockRecord& operator[](std::size_t block) noexcept { return records_[block]; }
  [[nodiscard]] const BlockRecord& operator[](std::size_t block) const noexcept { return records_[block]; }
  [[nodiscard]] static CollapseId first_id(std::size_t block) noexcept {
    return static_cast<CollapseId>(block * block_size);
  }
  // Returns an upper bound: all ids are smaller.
  [[nodiscard]] std::size_t end_id() const noexcept { return collapses_.size(); }
  [[nodiscard]] Collapse* const& collapse(CollapseId id) const noexcept { return collapses_[id]; }
  // Returns the collapses of a block that is finished.
  [[nodiscard]] std::span<Collapse* const> collapses(std::size_t block) const noexcept {
    return std::span<Collapse* const>(collapses_).subspan(first_id(block), records_[block].ranks.size());
  }
  // Adds a collapse with this id to the record of its block, given the faces that it ended. The faces in whose place
  // those were made are updated to name this collapse.
  void add(std::size_t block, CollapseId id, Collapse& collapse, std::span<const LevelFace> ended);

 private:
  std::vector<BlockRecord> records_;
  UninitializedVector<Collapse*> collapses_;  // by id
};

// Returns the shape of the faces that one collapse of v ended, and sorts them into ring order if they form one fan.
[[nodiscard]] StarShape shape_of(VertexId v, std::span<LevelFace> faces);

// Simplifies one block of vertices greedily, up to a cost threshold.

struct Block {
  std::span<VertexId> vertices;
  std::uint32_t first_place = 0;  // ids ascend from here
  std::size_t record = 0;         // record that receives its collapses
  float threshold = 0.0F;         // collapses that cost at most this are made, cheapest first
  std::size_t stop_after = 0;     // ends early when this many faces are gone
};

class CollapseWorker {
 public:
  CollapseWorker(SimplifyState& state, CollapseRecords& records) : state_(state), records_(records) {}
  // Runs the block. Vertices whose ring leaves the block are not changed. Calls go_on(faces gone) from time to time and
  // ends when it returns false.
  template <typename GoOn>
  void run(const Block& block, const GoOn& go_on) {
    start(block);
    while (go_on(faces_gone_) && take_steps()) continue;
    finish();
  }
  // Moves out the memory that holds the recorded collapses.
  [[nodiscard]] CollapseMemory take_memory() { return std::move(memory_); }

 private:
  struct Choice {
    VertexId u = no_id;
    float cost = 0.0F;
    bool keeps_topology = false;
    std::size_t place = 0;  // index of u in the ring
  };

  // Holds the data of a collapse that later collapses do not need.
  struct Made {
    VertexId v = no_id, u = no_id;
    std::size_t first_ended = 0;  // index into ended_
    float error = 0.0F;
    float moved = 0.0F;  // for a fan: set once its batch has been computed
    bool keeps_topology = false;
    bool is_ring = false;  // whether the faces that ended are a closed fan, in order
    float cost = 0.0F;
    float attribute_error = 0.0F;
    std::size_t first_corners = 0;  // index into corners_
  };
  // Holds a face that ended and the wedges at its corners.
  struct CornerFace {
    LevelFace face;
    Triangle wedges;
  };
  // Collects fans of one size whose movements are computed together, with their indices in made_.
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
  VertexRecord raise_ring(const Made& made, std::span<const LevelFace> ended, StarShape shape);
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
  std::vector<VertexMerge> merges_;
  std::vector<Made> made_;
  std::vector<LevelFace> ended_;
  AttributeStar attributes_;
  std::vector<CornerFace> corners_;  // ended faces with a wedge that is not its vertex's first
  std::vector<AttributeStar::WedgeMerge> wedge_merges_;
  std::vector<bool> taken_;
  std::vector<float> ring_costs_;
  std::vector<StarFace> folded_;
  std::size_t faces_gone_ = 0, last_gone_ = 0;
  float largest_cost_ = 0.0F, largest_error_ = 0.0F;    // where collapses are not wanted; in the state's scale
  std::array<Batch, Fan::max_neighbours + 1> batches_;  // by number of corners
  CollapseRecords& records_;
  CollapseMemory memory_;
};

}  // namespace occlod
