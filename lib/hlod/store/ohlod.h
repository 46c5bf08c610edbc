// Declares what writing and reading .ohlod files share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "base/byte_source.h"
#include "hlod/store/mesh_loader.h"
#include "mesh/section_file.h"
#include "occlod/hlod.h"
#include "occlod/node_store.h"

namespace occlod::ohlod {

// Of files with an origin, but without images of nodes.
inline constexpr std::uint32_t origin_version = 7;
// These are the versions of files without an origin: packed or not, and of the latter, with and without texture
// coordinates, materials or seams.
inline constexpr std::uint32_t packed_version = 6, wedges_version = 5, plain_version = 4;
// In files of these versions the boxes of nodes do not hold what has vanished.
inline constexpr std::uint32_t oldest_version = 1, last_narrow_version = 3;

// The carriage returns and the end-of-file byte reveal a transfer in text mode, as in PNG.
inline constexpr sections::FileKind file_kind{
    {'O', 'H', 'L', 'D', '\r', '\n', '\x1a', '\n'}, ohlod_version, ".ohlod", "make one with 'occlod hlod build'",
    "build it again with 'occlod hlod build'",      oldest_version};

// Holds everything in an HLOD that is not an array.
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

// Files hold these structures as they are in memory.
static_assert(sizeof(hlod::Patch) == 12 && sizeof(hlod::Node) == 112 && sizeof(hlod::NodeWithin) == 24 &&
              sizeof(hlod::NodeImage) == 24);

// Tells which attributes meshes have, in files of wedges_version or later.
enum WedgeFlag : std::uint32_t { has_texture_coordinates = 1, has_materials = 2, has_seams = 4, all_wedge_flags = 7 };

[[nodiscard]] inline std::uint32_t wedge_flags(const hlod::HlodView& view) {
  return (view.has_texture_coordinates ? has_texture_coordinates : 0U) | (view.has_materials ? has_materials : 0U) |
         (view.has_seams ? has_seams : 0U);
}

// Returns whether an HLOD needs wedges_version.
[[nodiscard]] inline bool needs_wedges(const hlod::HlodView& view) {
  return wedge_flags(view) != 0 || !view.materials.empty() || !view.textures.empty();
}

// The section lattice_name holds one float, HlodView::lattice_step, where there is one.
inline constexpr std::string_view summary_name = "INFO", lattice_name = "LATT", meshes_name = "MESH",
                                  digests_name = "BLOK", splits_name = "WSPL", splits_digests_name = "WBLK",
                                  node_images_name = "NIMG", images_name = "IMGS", image_materials_name = "IMAT";

// A packed file has these sections instead of meshes_name and splits_name: the output of node_codec.h for each node,
// and the places where each begins, followed by the end of the last.
inline constexpr std::string_view packed_meshes_name = "PMSH", mesh_places_name = "PMPL", packed_splits_name = "PSPL",
                                  splits_places_name = "PSPP";

// Calls visit(name, array, has_parts) for every array of an HLOD, which defines what a file holds. Arrays with parts
// are checked node by node.
template <typename View, typename Visit>
void for_each_array(View& view, const Visit& visit) {
  visit("NODE", view.nodes, false);
  visit("PTCH", view.patches, false);
  visit("CHIL", view.children, false);
  visit("ROOT", view.roots, false);
  visit("LEVL", view.levels, false);
  visit(meshes_name, view.meshes, true);
}

// Calls visit(name, array, has_parts) for the arrays of refinement within nodes, which a file may lack.
template <typename View, typename Visit>
void for_each_within_array(View& view, const Visit& visit) {
  visit("WNOD", view.within, false);
  visit(splits_name, view.splits, true);
}

// How a file that is far away is read. Images of materials and features are not.
struct FarAway {
  // Makes what reads the meshes of a source: see MeshSource::make_queue(). Null: the file is here.
  std::function<std::unique_ptr<hlod::LoadQueue>(hlod::MeshSource& source)> make_queue;
  // Is told in a line of each node's image that has come damaged: its bytes are 0.
  std::function<void(const std::string& problem)> drop_image;
};

// Opens a file as the public open_ohlod() does; `name` stands for it in messages.
[[nodiscard]] OhlodFile open_ohlod(std::shared_ptr<const ByteSource> file, const std::filesystem::path& name,
                                   const hlod::CacheOptions& cache, FarAway far = {});

// Returns the XXH3-64 of the mesh of a node with padding for the next. The place of the mesh has been checked.
[[nodiscard]] std::uint64_t digest_of_mesh(const hlod::HlodView& view, hlod::NodeId n);
// Returns the XXH3-64 of the node's splits with padding for the next. Their place has been checked.
[[nodiscard]] std::uint64_t digest_of_splits(const hlod::HlodView& view, hlod::NodeId n);

}  // namespace occlod::ohlod
