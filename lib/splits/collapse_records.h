// What blocks record of their collapses, found again by the ids of these.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "splits/attribute_star.h"
#include "splits/simplify.h"

namespace occlod {

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

}  // namespace occlod
