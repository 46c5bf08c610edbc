// Makes the tiles of a tileset, one for each node of an HLOD, with their bounds, and writes them as JSON.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "hlod/tiles/encode_tile.h"
#include "hlod/tiles/tileset_files.h"
#include "occlod/hlod.h"
#include "occlod/tiles.h"

namespace occlod::tiles {

// Names what a tile's geometricError is.
enum class TileError {
  guaranteed,  // Node::guaranteed_error: no point of the tile is farther from the input
  quadric,     // Node::error: smaller, and not a bound; for comparisons
};

struct Tile {
  double error = 0.0;          // geometricError: 0 at leaves, else more than any child's
  TileBox box;                 // around the content and the children's boxes
  double texture_error = 0.0;  // size of a texel where it is larger than the source's; counts as an error
  // Errors of further tiles above this one, ascending: the same triangles with coarser images, where the parent is so
  // much coarser that this tile's texels would be far smaller than pixels when it comes into sight.
  std::vector<double> coarser = {};
  TileBox content_box;       // empty: the tile has no content, since everything in it has vanished
  std::uint32_t extent = 1;  // number of tiles from here down in the same file, references to other files included
  bool is_external = false;  // its tileset is a separate file

  // Returns the error of the tile that the parent has as a child.
  [[nodiscard]] double outer_error() const noexcept { return coarser.empty() ? error : coarser.back(); }
};

// Holds a tile for each node. Give tiles their boxes first, then call complete() once.
class TileTree {
 public:
  explicit TileTree(const hlod::Hlod& hlod) : hlod_(hlod), tiles_(hlod.node_count()) {}

  [[nodiscard]] const hlod::Hlod& hlod() const noexcept { return hlod_; }
  [[nodiscard]] Tile& operator[](hlod::NodeId n) { return tiles_[n]; }
  [[nodiscard]] const Tile& operator[](hlod::NodeId n) const { return tiles_[n]; }

  // Computes errors and boxes, and divides tiles into files: a tile with more than `tiles_per_file` tiles below it
  // moves its largest subtrees into files of their own.
  void complete(TileError error, std::uint32_t tiles_per_file);
  // Returns the box of all tiles.
  [[nodiscard]] const TileBox& box() const noexcept { return box_; }
  // Returns the error of drawing nothing: the diagonal of the box, or a little more than the coarsest tile's error.
  [[nodiscard]] double error() const noexcept { return error_; }

 private:
  void bound(hlod::NodeId n, TileError error);
  void divide(std::size_t own_tiles, std::vector<hlod::NodeId> children, std::uint32_t tiles_per_file,
              std::uint32_t& extent);

  const hlod::Hlod& hlod_;
  std::vector<Tile> tiles_;
  TileBox box_;
  double error_ = 0.0;
};

// Returns the parent of node n; no_id for a root.
[[nodiscard]] hlod::NodeId parent_of(const hlod::Hlod& hlod, hlod::NodeId n);

// Returns the name of a tile's content, relative to the tileset's folder; `coarser` is the number of the tile among
// those of the node, 0 for the finest.
[[nodiscard]] std::string content_name(hlod::NodeId n, std::size_t coarser = 0);

// Writes tileset.json and the external tilesets. Returns how many files it has written. `transform` applies to the
// whole tileset. tileset.json lists `images`, the names of all other files in the folder that no tile names, for who
// replaces it. `tree` must be complete.
std::uint64_t write_tileset_json(TilesetFiles& files, const TileTree& tree, const std::optional<glm::dmat4>& transform,
                                 const std::set<std::string>& images);

// Returns the transform from metres to the east, north and up of a place on the WGS84 ellipsoid to Earth-centred,
// Earth-fixed metres. At the poles, east is the limit along the meridian of the given longitude.
[[nodiscard]] glm::dmat4 east_north_up(const GeodeticOrigin& origin);

// Throws what write_tileset() throws for these options.
void check_tileset_options(const TilesetOptions& options);

// The most tiles in a .json file, unless those of one with its children are more.
inline constexpr std::uint32_t usual_tiles_per_file = 1000;
// As without a number of tiles in a file, >= 1.
TilesetCounts write_tileset(const std::filesystem::path& path, const hlod::Hlod& hlod, const TilesetOptions& options,
                            std::uint32_t tiles_per_file);

}  // namespace occlod::tiles
