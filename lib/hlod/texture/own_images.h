// Makes an image for each node of an HLOD, of what its triangles show, at the resolution that its error needs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "base/memory.h"
#include "hlod/texture/source_textures.h"
#include "hlod/texture/tile_texture.h"
#include "occlod/hlod.h"
#include "occlod/tiles.h"

namespace occlod::hlod {

// What HlodView has of nodes with images.
struct OwnImages {
  std::vector<Node> nodes;  // whose errors are no less than their texels
  std::vector<NodeImage> table;
  LargeVector<std::byte> bytes;
  std::vector<std::uint8_t> materials;
};

// How many times larger texels of one image are than those of the next finer one, at least: all coarser ones together
// take about a fifth of the finest's.
inline constexpr double coarser_by = 2.5;

// Returns the size of texels that an error needs, object units, where texels that are shown have a mean size of `mean`;
// 0: the source's. Each level coarsens them, as geometry does: else flat surfaces, which have no error, would show the
// whole source again and again.
[[nodiscard]] double texel_size_of(const Node& node, double error, double mean);

// Returns an image for each node, from the images that SourceTextures divides; an empty table where it divides none.
// Images are found in `image_folder`. The same arguments give the same bytes, whatever the number of threads, >= 1.
// `progress`, unless empty, is called with the share done, in [0, 1]. Throws Error for damaged images. O(size +
// texels). What an ImageJournal in the file `journal` has is not made again; empty: none is kept.
[[nodiscard]] OwnImages make_own_images(const Hlod& hlod, const std::filesystem::path& image_folder,
                                        const std::filesystem::path& journal, unsigned threads,
                                        const std::function<void(double)>& progress);

}  // namespace occlod::hlod
