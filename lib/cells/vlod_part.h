// The .vpart file: the trees of a run of root cells, to be merged into a .vlod file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "occlod/viewcells/build_cells.h"
#include "cells/packed_tree.h"
#include "cells/vlod_format.h"

namespace occlod::vlod {

inline constexpr sections::FileKind part_kind{{'V', 'P', 'R', 'T', '\r', '\n', '\x1a', '\n'},
                                              vlod_version,
                                              ".vpart",
                                              "make one with 'occlod cells build --work'",
                                              "remove it, and build again with --resume"};

// `trees`: of the root cells of the range. Throws Error that names the file.
void write_part(const std::filesystem::path& path, const Scene& scene, const CellRange& range,
                std::span<const PackedTree> trees);

// Where the tree of a root cell is.
struct PartTree {
  std::uint64_t first_node = 0, nodes = 0;        // in section CELL
  std::uint64_t payloads = 0, payload_bytes = 0;  // in section DATA
  std::uint64_t sets = 0;                         // in section DATA: what all leaves share, then what some have
  std::uint64_t shared_bytes = 0, used_bytes = 0;
  SetCounts counts;
};
static_assert(sizeof(PartTree) == 96);

class PartReader {
 public:
  // Checks all of the file but what sets hold. Throws Error.
  explicit PartReader(const std::filesystem::path& path);

  [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
  [[nodiscard]] const Key& key() const noexcept { return key_; }
  [[nodiscard]] const CellRange& range() const noexcept { return range_; }
  // Of this root cell, which is in the range. Throws Error.
  [[nodiscard]] CellSubtree tree(std::uint32_t root) const;

 private:
  sections::SectionReader reader_;
  Scene scene_;
  Key key_{};
  CellRange range_;
  std::span<const PartTree> trees_;
  std::span<const CellNode> nodes_;
  std::span<const std::byte> data_;
};

}  // namespace occlod::vlod
