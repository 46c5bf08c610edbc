// The tiles of a tileset: those of an HLOD's nodes, with the bounds that clients go by.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "hlod/tiles/encode_tile.h"
#include "occlod/hlod.h"
#include "occlod/tiles.h"

namespace occlod::tiles {

// What a tile's geometricError is.
enum class TileError {
  guaranteed,  // Node::guaranteed_error: no point of the tile is farther from the input
  quadric,     // Node::error: smaller, and not a bound; for comparisons
};

struct Tile {
  double error = 0.0;        // geometricError: 0 at leaves, else more than any child's
  TileBox box;               // of the content and of the children's boxes
  TileBox content_box;       // empty: the tile has no content, since all has vanished
  std::uint32_t extent = 1;  // tiles from here down in the same file, those that refer to others among them
  bool is_external = false;  // its tileset is a file of its own
};

// By node. Tiles are given their boxes first, then complete() is called once.
class TileTree {
 public:
  explicit TileTree(const hlod::Hlod& hlod) : hlod_(hlod), tiles_(hlod.node_count()) {}

  [[nodiscard]] const hlod::Hlod& hlod() const noexcept { return hlod_; }
  [[nodiscard]] Tile& operator[](hlod::NodeId n) { return tiles_[n]; }
  [[nodiscard]] const Tile& operator[](hlod::NodeId n) const { return tiles_[n]; }

  // Errors, boxes, files: a tile below which there are more than `tiles_per_file` gives away its largest subtrees.
  void complete(TileError error, std::uint32_t tiles_per_file);
  // Of all tiles.
  [[nodiscard]] const TileBox& box() const noexcept { return box_; }
  // Of drawing nothing: the diagonal of the box, or a little more than the coarsest tile's.
  [[nodiscard]] double error() const noexcept { return error_; }

 private:
  void bound(hlod::NodeId n, TileError error);
  void divide(std::vector<hlod::NodeId> children, std::uint32_t tiles_per_file, std::uint32_t& extent);

  const hlod::Hlod& hlod_;
  std::vector<Tile> tiles_;
  TileBox box_;
  double error_ = 0.0;
};

// Of node n, or no_id of a root.
[[nodiscard]] hlod::NodeId parent_of(const hlod::Hlod& hlod, hlod::NodeId n);

// tileset.json and the external tilesets.

// Relative to the folder.
[[nodiscard]] std::string content_name(hlod::NodeId n);

// How many files it has written. `transform`: of the whole tileset. `tree` is complete.
std::uint64_t write_tileset_json(AtomicFolder& folder, const TileTree& tree,
                                 const std::optional<glm::dmat4>& transform);

// Places on the WGS84 ellipsoid.

// From metres to the east, north and up of a place to Earth-centred, Earth-fixed metres. At the poles east is where it
// is along the meridian of the given longitude.
[[nodiscard]] glm::dmat4 east_north_up(const GeodeticOrigin& origin);

// The most tiles in a .json file, unless those of one with its children are more.
inline constexpr std::uint32_t usual_tiles_per_file = 1000;
// As without a number of tiles in a file, >= 1.
TilesetCounts write_tileset(const std::filesystem::path& folder, const hlod::Hlod& hlod, const TilesetOptions& options,
                            std::uint32_t tiles_per_file);

}  // namespace occlod::tiles
