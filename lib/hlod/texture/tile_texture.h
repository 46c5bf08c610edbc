// Makes the image of a tile: the charts that its triangles show, packed anew, at the resolution that its error needs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/memory.h"
#include "hlod/texture/source_textures.h"
#include "occlod/mesh.h"
#include "occlod/tiles.h"

namespace occlod::tiles {

struct TileImage {
  int width = 0, height = 0;               // multiples of 4; 0: the tile shows no divided image
  LargeVector<glm::u8vec4> pixels;         // sRGB and alpha, rows from the top
  LargeVector<std::uint8_t> is_free;       // by pixel: nothing reads it, and it may have any colour
  std::vector<std::uint8_t> is_of_tile;    // by material: it shows this image, in place of its own
  std::vector<std::uint8_t> is_of_vertex;  // by vertex: a triangle of such a material has it
  double texel_size = 0.0;                 // object units, of the largest that is larger than its source's; 0: none
  std::uint64_t charts = 0;
};

// What a mesh shows of divided images.
struct ShownTexels {
  double mean_size = 0.0;  // of a texel, object units; 0: it shows none
  std::size_t charts = 0;
};

// Needs the sizes of the images only, not their pixels. O(n log n).
[[nodiscard]] ShownTexels shown_texels(const TriangleMesh& mesh, const SourceTextures& sources);

// Packs what the mesh, which has no extra wedges, shows of divided images into one image, and makes its texture
// coordinates lead there. Texels have about `texel_size` object units, but are never finer than their source's; those
// of whole size are copied, and show what their source shows at every place of every triangle. Smaller ones are means
// over an area, in linear light, of what their chart alone shows; what no triangle shows is filled with what is near.
// The same arguments give the same pixels. O(n log n + texels).
[[nodiscard]] TileImage make_tile_image(TriangleMesh& mesh, const SourceTextures& sources, double texel_size);

// Encodes the pixels, free ones in the colours that take the fewest bytes; PNG where one is not opaque, whatever the
// format. O(pixels).
[[nodiscard]] std::vector<std::uint8_t> encode(TileImage image, TextureFormat format);

}  // namespace occlod::tiles
