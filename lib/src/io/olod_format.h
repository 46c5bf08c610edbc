// The parts that writing and reading .olod files share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/io/olod.h"
#include "section_file.h"

namespace occlod::olod {

// The carriage returns and the end-of-file byte reveal a transfer in text mode, as in PNG.
inline constexpr sections::FileKind file_kind{{'O', 'L', 'O', 'D', '\r', '\n', '\x1a', '\n'},
                                              olod_version,
                                              ".olod",
                                              "make one with 'occlod build'",
                                              "build it again with 'occlod build'"};

// Everything in a hierarchy that is not an array.
struct Summary {
  Box box;
  std::uint64_t input_triangle_count = 0;
  std::uint64_t face_count = 0;
  float error_bound = 0.0F;
  std::uint32_t reserved = 0;
};
static_assert(sizeof(Summary) == 48);

inline constexpr std::string_view summary_name = "INFO", digests_name = "BLOK";

// Calls visit(name, array, has_blocks) for every array of a hierarchy: the one list of what a file holds. Those with
// blocks are checked block by block.
template <typename View, typename Visit>
void for_each_array(View& view, const Visit& visit) {
  visit("POSI", view.positions, true);
  visit("NORM", view.normals, true);
  visit("COLR", view.colors, true);
  visit("NODE", view.nodes, true);
  visit("STAR", view.stars, true);
  visit("ROOT", view.roots, false);
  visit("BASE", view.base_faces, false);
}

// XXH3-64 of what belongs to the base vertices: positions, normals, colors.
[[nodiscard]] std::uint64_t digest_of_base(const HierarchyView& view);
// And of what belongs to a block of SplitGuard::block_size splits: nodes, stars, positions, normals, colors. The places
// of the stars have been checked.
[[nodiscard]] std::uint64_t digest_of_block(const HierarchyView& view, std::size_t block);

struct BlockRange {
  std::size_t first, end;  // splits
};
[[nodiscard]] BlockRange range_of_block(const HierarchyView& view, std::size_t block);

}  // namespace occlod::olod
