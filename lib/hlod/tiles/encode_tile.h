// The content of a tile: a binary glTF file.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/file_input.h"
#include "occlod/tiles/write_tileset.h"
#include "hlod/tiles/tile_box.h"
#include "hlod/tiles/tile_mesh.h"

namespace occlod::tiles {

struct TileFormat {
  Compression compression = Compression::none;
  int quantise_bits = 0;  // 0: floats
};

// What the materials of an HLOD look like.
struct TileLook {
  std::span<const Material> materials;
  std::span<const Texture> textures;
  std::vector<std::string> images;  // by texture: its uri from a content; empty: left out
  TextureOrigin origin = TextureOrigin::top_left;
};

struct TileContent {
  std::string bytes;  // of the file
  TileBox box;        // of its vertices, as they are decoded
};

// Y up, as glTF has it: clients turn that to z up. Positions count from a place within the tile's box, or from a plane
// of the origin where that is as near, so that as floats they are exact; as integers from a lattice that neighbours of
// about the same size share. A content has the
// materials that it uses. `tile` has triangles. Fails for files of more than 4 GiB. O(n).
[[nodiscard]] TileContent encode_tile(const TileMesh& tile, const TileLook& look, const TileFormat& format,
                                      const FileErrors& errors);

}  // namespace occlod::tiles
