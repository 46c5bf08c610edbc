// The parts that writing and reading .ohlod files share.
#pragma once

#include <cstdint>
#include <string_view>

#include "occlod/hlod/hlod.h"
#include "occlod/io/ohlod.h"
#include "section_file.h"

namespace occlod::ohlod {

// Of files without texture coordinates, materials and seams.
inline constexpr std::uint32_t plain_version = 1;

// The carriage returns and the end-of-file byte reveal a transfer in text mode, as in PNG.
inline constexpr sections::FileKind file_kind{
    {'O', 'H', 'L', 'D', '\r', '\n', '\x1a', '\n'}, ohlod_version, ".ohlod", "make one with 'occlod hlod build'",
    "build it again with 'occlod hlod build'",      plain_version};

// Everything in an HLOD that is not an array.
struct Summary {
  Box box;
  std::uint64_t input_triangle_count = 0;
  std::uint32_t grouping = 0;
  std::uint32_t borders = 0;
  std::uint32_t node_triangles = 0;
  std::uint32_t has_normals = 0;  // 0 or 1
  std::uint32_t has_colors = 0;   // 0 or 1
  std::uint32_t wedges = 0;       // bits of WedgeFlag
};
static_assert(sizeof(Summary) == 56);

// What meshes have, of version 2.
enum WedgeFlag : std::uint32_t { has_texture_coordinates = 1, has_materials = 2, has_seams = 4, all_wedge_flags = 7 };

[[nodiscard]] inline std::uint32_t wedge_flags(const hlod::HlodView& view) {
  return (view.has_texture_coordinates ? has_texture_coordinates : 0U) | (view.has_materials ? has_materials : 0U) |
         (view.has_seams ? has_seams : 0U);
}

// Whether an HLOD needs version 2.
[[nodiscard]] inline bool needs_wedges(const hlod::HlodView& view) {
  return wedge_flags(view) != 0 || !view.materials.empty() || !view.textures.empty();
}

inline constexpr std::string_view summary_name = "INFO", meshes_name = "MESH", digests_name = "BLOK",
                                  splits_digests_name = "WBLK";

// Calls visit(name, array, has_parts) for every array of an HLOD: the one list of what a file holds. That with parts is
// checked node by node.
template <typename View, typename Visit>
void for_each_array(View& view, const Visit& visit) {
  visit("NODE", view.nodes, false);
  visit("PTCH", view.patches, false);
  visit("CHIL", view.children, false);
  visit("ROOT", view.roots, false);
  visit("LEVL", view.levels, false);
  visit(meshes_name, view.meshes, true);
}

// The same for the arrays of refinement within nodes, which a file may lack.
template <typename View, typename Visit>
void for_each_within_array(View& view, const Visit& visit) {
  visit("WNOD", view.within, false);
  visit("WSPL", view.splits, true);
}

// XXH3-64 of the mesh of a node and what aligns the next one. The place of the mesh has been checked.
[[nodiscard]] std::uint64_t digest_of_mesh(const hlod::HlodView& view, hlod::NodeId n);
// The same for its splits.
[[nodiscard]] std::uint64_t digest_of_splits(const hlod::HlodView& view, hlod::NodeId n);

}  // namespace occlod::ohlod
