// Declares what the writer and the reader of .olod files share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/section_file.h"
#include "occlod/build_hierarchy.h"
#include "occlod/hierarchy.h"

namespace occlod::olod {

// Versions of files without an origin, with and without texture coordinates, materials or seams.
inline constexpr std::uint32_t wedges_version = 3, plain_version = 2;

// The carriage returns and the end-of-file byte reveal a transfer in text mode, as in PNG.
inline constexpr sections::FileKind file_kind{
    {'O', 'L', 'O', 'D', '\r', '\n', '\x1a', '\n'}, olod_version, ".olod", "make one with 'occlod build'",
    "build it again with 'occlod build'",           plain_version};

// Holds everything in a hierarchy that is not an array.
struct Summary {
  Box box;
  std::uint64_t input_triangle_count = 0;
  std::uint64_t face_count = 0;
  float error_bound = 0.0F;
  std::uint32_t reserved = 0;
};
static_assert(sizeof(Summary) == 48);

inline constexpr std::string_view summary_name = "INFO", digests_name = "BLOK";

// Calls visit(name, array, has_blocks) for every array of a hierarchy: the one list of what a file holds. Arrays with
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

// Calls visit in the same way for the arrays that only version 3 has, skipping empty ones.
template <typename View, typename Visit>
void for_each_wedge_array(View& view, const Visit& visit) {
  visit("UVS0", view.texture_coordinates, true);
  visit("WEDG", view.extra_wedges, false);
  visit("WMAT", view.wedge_materials, true);
  visit("CORN", view.corners, true);
  visit("CSTA", view.corner_starts, true);
  visit("BCOR", view.base_corners, false);
  visit("AERR", view.attribute_errors, true);
}

// Returns whether a hierarchy has texture coordinates, materials or seams.
[[nodiscard]] bool has_looks(const HierarchyView& view);
// Returns whether a hierarchy needs version 3, because of these or of errors of attributes.
[[nodiscard]] bool needs_wedges(const HierarchyView& view);

// Returns the XXH3-64 of the attributes of the base vertices' wedges.
[[nodiscard]] std::uint64_t digest_of_base(const HierarchyView& view);
// Returns the XXH3-64 of a block of SplitGuard::block_size splits: nodes, stars, corners, and the attributes of the
// wedges of their vertices. The places of stars and corners must have been checked.
[[nodiscard]] std::uint64_t digest_of_block(const HierarchyView& view, std::size_t block);

struct BlockRange {
  std::size_t first, end;  // splits
};
[[nodiscard]] BlockRange range_of_block(const HierarchyView& view, std::size_t block);

}  // namespace occlod::olod
