// Writes an HLOD of nested groups as a tileset of 3D Tiles 1.1, for CesiumJS, cesium-native, 3DTilesRendererJS and
// others. docs/guide/tiles.md says what is in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "occlod/build_hlod.h"
#include "occlod/hlod.h"

namespace occlod::tiles {

// Returns how to build an HLOD that becomes a tileset: nested groups, since tiles form a tree, with free borders, so
// that coarse tiles do not keep the fine triangles at their edges.
[[nodiscard]] hlod::HlodBuildOptions build_options();

// How the contents of tiles are compressed.
enum class Compression {
  none,
  meshopt,  // EXT_meshopt_compression; needs a build with meshoptimizer
};

// How the images of tiles are encoded.
enum class TextureFormat {
  png,   // without loss
  jpeg,  // at quality 90; PNG where something is transparent
};

// A place on or above the WGS84 ellipsoid.
struct GeodeticOrigin {
  double longitude_deg = 0.0;  // in [-180, 180], east of Greenwich
  double latitude_deg = 0.0;   // in [-90, 90], north of the equator
  double height_m = 0.0;       // above the ellipsoid, not the sea; in [-1e7, 1e9]
};

// How a tileset is written. One unit of the HLOD is a metre. Clients refine by Node::guaranteed_error: no point of a
// tile is farther from the input. An HLOD without normals gets those of crease_normals() at 60 degrees.
struct TilesetOptions {
  Compression compression = Compression::none;  // of contents
  // Bits of each coordinate within its tile, by KHR_mesh_quantization, in [8, 16]; normals then have 8. 0: positions
  // and normals are floats, and those of the finest tiles the input's, bit for bit. Nothing: 14 with compression, else
  // 0.
  std::optional<int> quantise_bits;
  // Where the edge of a tile is none of the input, a strip hangs from it against the normals, as deep as the parent's
  // Node::error: it covers gaps between tiles of different levels.
  bool skirts = false;
  std::optional<UpAxis> up;              // of the HLOD; tilesets have z. Nothing: HlodView::up
  std::optional<GeodeticOrigin> origin;  // where the HLOD's origin is, x to the east; nothing: no place on Earth
  // Where image files are: names are relative to it, with or without their first folders. That of the .ohlod file, as
  // write_ohlod() wrote their names, or that of the scene or mesh.
  std::filesystem::path image_folder;
  // Of the images that tiles have of their own; nothing: JPEG where all images that are divided among them are, else
  // PNG.
  std::optional<TextureFormat> texture_format;
  int threads = 0;       // in [0, 1024]; 0: one for each core. The result does not depend on it
  bool replace = false;  // a tileset in the folder, if nothing else is there, or the file
  // Called now and then with the share done, in [0, 1]. What it throws ends the writing, and leaves what is
  // there.
  std::function<void(double)> progress = {};
};

// An image that stays one file for all tiles.
struct SharedImage {
  std::string name;    // of its file, or `image N` of an embedded one
  std::string reason;  // why it is not divided among tiles
};

// What was written.
struct TilesetCounts {
  std::uint64_t tiles = 0;            // with a content
  std::uint64_t tileset_files = 0;    // .json
  std::uint64_t triangles = 0;        // of all contents, without skirts
  std::uint64_t skirt_triangles = 0;  // of all contents
  std::uint64_t content_bytes = 0;    // of all contents
  std::uint64_t bytes = 0;            // of all files, or of the archive
  std::uint64_t texels = 0;           // of the images of all tiles
  std::uint64_t source_texels = 0;    // of the images that are divided among them
  std::uint64_t texture_bytes = 0;    // of the images of all tiles, encoded
  std::uint64_t charts = 0;           // of all tiles: connected parts of their images
  // That stay one file for all tiles.
  std::vector<SharedImage> images_shared;
  // Of textures: files that are not there, and images in a format that glTF lacks, with all its extensions. Materials
  // are written without them.
  std::vector<std::string> images_left_out;
};

// Writes tileset.json and what it refers to: into the file `path` where that ends in .3tz, by the 3D Tiles Archive
// Format 1.3, else into the folder `path`. Either is new, a folder may be empty, or as `replace` has it. Writes beside
// it and renames, so that a failure leaves it as it was. Meshes are read one at a time, so an HLOD in a mapped file
// need not fit into memory; the vertices at borders of level 0 must, at some 100 bytes each, where normals or skirts
// are made. The same arguments give the same bytes.
//
// Throws Error for an option out of its range, for an HLOD of shifted groups, which is no tree, or without triangles,
// for what check_tileset_output() refuses, and when a file cannot be read or written. O(size).
TilesetCounts write_tileset(const std::filesystem::path& path, const hlod::Hlod& hlod,
                            const TilesetOptions& options = {});

// Throws what write_tileset() throws for this path and writes nothing, for programs that compute for long before.
void check_tileset_output(const std::filesystem::path& path, bool replace);

}  // namespace occlod::tiles
