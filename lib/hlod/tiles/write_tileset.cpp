#include "occlod/tiles/write_tileset.h"

#include <algorithm>
#include <glm/mat4x4.hpp>
#include <utility>

#include "base/option_checker.h"
#include "base/atomic_folder.h"
#include "base/file_input.h"
#include "occlod/core/error.h"
#include "hlod/tiles/border_vertices.h"
#include "hlod/tiles/encode_tile.h"
#include "hlod/tiles/geodetic.h"
#include "hlod/tiles/meshopt_codec.h"
#include "hlod/tiles/tile_images.h"
#include "hlod/tiles/tile_mesh.h"
#include "hlod/tiles/tile_tree.h"
#include "hlod/tiles/tileset_json.h"

namespace occlod::tiles {
namespace {

constexpr std::size_t most_levels = 100;  // files are nested as deeply

void check(const TilesetOptions& options) {
  const OptionChecker checker("tileset options");
  if (options.quantise_bits && *options.quantise_bits != 0)
    checker.in_range("quantise_bits", *options.quantise_bits, 8, 16);
  checker.in_range("crease_deg", options.crease_deg, 0.0, 180.0);
  checker.in_range("tiles_per_file", options.tiles_per_file, 1, 1e6);
  if (options.origin) {
    checker.in_range("longitude_deg", options.origin->longitude_deg, -180.0, 180.0);
    checker.in_range("latitude_deg", options.origin->latitude_deg, -90.0, 90.0);
    checker.in_range("height_m", options.origin->height_m, -1e7, 1e9);
  }
  if (options.compression == Compression::meshopt && !has_meshopt())
    throw Error({"tileset options", "", "this build of occlod has no EXT_meshopt_compression",
                 "build it with meshoptimizer, or write without compression"});
}

void check(const hlod::Hlod& hlod) {
  const hlod::HlodView& view = hlod.data();
  if (view.nodes.empty()) throw Error({"HLOD", "", "has no nodes", "build it from a mesh with triangles"});
  const bool is_tree =
      view.grouping == hlod::Grouping::nested &&
      std::all_of(view.nodes.begin(), view.nodes.end(), [](const hlod::Node& n) { return n.patches <= 1; });
  if (!is_tree)
    throw Error({"HLOD", "", "has nodes with several parents, and tiles form a tree",
                 "build it with nested groups: --grouping nested --borders free"});
  if (view.levels.size() > most_levels) throw Error({"HLOD", "", "has more than 100 levels", "build it again"});
}

std::optional<glm::dmat4> transform_of(const TilesetOptions& options) {
  if (!options.origin && options.up == UpAxis::z) return std::nullopt;
  glm::dmat4 transform(1.0);
  if (options.origin) transform = east_north_up(*options.origin);
  if (options.up == UpAxis::y) transform = {transform[0], transform[2], -transform[1], transform[3]};
  return transform;
}

class TilesetWriter {
 public:
  TilesetWriter(const std::filesystem::path& folder, const hlod::Hlod& hlod, const TilesetOptions& options)
      : errors_(folder), folder_(folder), hlod_(hlod), options_(options), tree_(hlod) {
    const int usual_bits = options.compression == Compression::none ? 0 : 14;
    format_ = {options.compression, options.quantise_bits.value_or(usual_bits)};
    needs_borders_ = !hlod.data().has_normals || options.skirts;
    steps_ = hlod.node_count() + (needs_borders_ ? hlod.data().levels[0].node_count : 0);
  }

  TilesetCounts run() && {
    if (needs_borders_) borders_ = BorderVertices(hlod_, [this] { step(); });
    look_ = write_images(folder_, hlod_.data(), options_.image_folder, counts_.images_left_out);
    for (hlod::NodeId n = 0; n < hlod_.node_count(); ++n) {
      step();
      write_tile(n);
    }
    tree_.complete(options_.error, options_.tiles_per_file);
    counts_.tileset_files = write_tileset_json(folder_, tree_, transform_of(options_));
    counts_.bytes = folder_.bytes();
    folder_.commit();
    return counts_;
  }

 private:
  void step() {
    if (options_.progress) options_.progress(static_cast<double>(done_) / static_cast<double>(steps_));
    ++done_;
  }

  void write_tile(hlod::NodeId n) {
    if (hlod_.node(n).triangles == 0) return;
    hlod_.require(n);
    TileMesh tile = tile_mesh(hlod_, n, options_.crease_deg, borders_);
    if (tile.mesh.triangles.empty()) return;
    const hlod::NodeId parent = parent_of(hlod_, n);
    if (options_.skirts && parent != no_id) add_skirts(tile, hlod_.node(parent).error, borders_);
    const TileContent content = encode_tile(tile, look_, format_, errors_);
    folder_.write(content_name(n), content.bytes);
    tree_[n].content_box = content.box;
    ++counts_.tiles;
    counts_.triangles += tile.mesh.triangles.size() - tile.skirt_triangles;
    counts_.skirt_triangles += tile.skirt_triangles;
    counts_.content_bytes += content.bytes.size();
  }

  FileErrors errors_;
  AtomicFolder folder_;
  const hlod::Hlod& hlod_;
  const TilesetOptions& options_;
  TileFormat format_;
  bool needs_borders_ = false;
  BorderVertices borders_;
  TileLook look_;
  TileTree tree_;
  TilesetCounts counts_;
  std::size_t steps_ = 0;  // in all, for progress
  std::size_t done_ = 0;
};

}  // namespace

TilesetCounts write_tileset(const std::filesystem::path& folder, const hlod::Hlod& hlod,
                            const TilesetOptions& options) {
  check(options);
  check(hlod);
  check_tileset_output(folder, options.replace);
  return TilesetWriter(folder, hlod, options).run();
}

}  // namespace occlod::tiles
