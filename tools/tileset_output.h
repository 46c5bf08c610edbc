// Writes an HLOD as a tileset, with the options of `occlod tiles` that say how.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "hlod/tiles/tile_tree.h"
#include "hlod/tiles/tileset_files.h"
#include "json_output.h"
#include "occlod/hlod.h"
#include "occlod/tiles.h"
#include "progress.h"

namespace CLI {
class App;
}

namespace occlod::tool {

struct TilesetOutput {
  std::string path;    // of a folder or, where it ends in .3tz, an archive
  std::string origin;  // LON,LAT,H; empty: no place on Earth
  std::string images;  // folder; empty: that of the input
  tiles::TilesetOptions tileset;
  std::uint32_t tiles_per_file = tiles::usual_tiles_per_file;
};

// Adds --output, --compress, --quantise, --skirts, --up, --origin, --images, --replace and --tiles-per-file.
void add_tileset_output(CLI::App& command, TilesetOutput& output);

// Throws for options that do not fit, and for a path that is not to be had, before anything takes long.
void check(const TilesetOutput& output);

// Writes the tileset and notes which images it lacks. Image names lead from `input_folder` unless --images is given.
// Returns folder or archive, up and counts.
[[nodiscard]] Json write_tileset(const TilesetOutput& output, const hlod::Hlod& hlod,
                                 const std::filesystem::path& input_folder, Progress& progress);

}  // namespace occlod::tool
