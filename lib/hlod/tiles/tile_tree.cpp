#include "hlod/tiles/tile_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "occlod/base.h"

namespace occlod::tiles {
namespace {

// Returns the least error above another that clients can tell apart from it, even as floats.
double above(double error, double extent) { return std::max(error * (1.0 + 1e-6), extent * 1e-9); }

}  // namespace

hlod::NodeId parent_of(const hlod::Hlod& hlod, hlod::NodeId n) {
  return hlod.patches(n).empty() ? no_id : hlod.patches(n)[0].parent;
}

void TileTree::complete(TileError error, std::uint32_t tiles_per_file) {
  // Children have larger ids than their parents.
  for (hlod::NodeId n = static_cast<hlod::NodeId>(tiles_.size()); n-- > 0;) {
    bound(n, error);
    const std::span<const hlod::NodeId> children = hlod_.children(n);
    divide(1 + tiles_[n].coarser.size(), {children.begin(), children.end()}, tiles_per_file, tiles_[n].extent);
  }
  double largest = 0.0;
  for (const hlod::NodeId n : hlod_.data().roots) {
    box_.take(tiles_[n].box);
    largest = std::max(largest, tiles_[n].outer_error());
  }
  const double diagonal = glm::length(box_.max - box_.min);
  error_ = std::max(diagonal, above(largest, diagonal));
  std::uint32_t extent = 1;
  const std::span<const hlod::NodeId> roots = hlod_.data().roots;
  if (roots.size() > 1) divide(1, {roots.begin(), roots.end()}, tiles_per_file, extent);
}

void TileTree::bound(hlod::NodeId n, TileError error) {
  const hlod::Node& node = hlod_.node(n);
  Tile& tile = tiles_[n];
  tile.content_box = tile.content_box.is_empty() ? tile.content_box : thickened(tile.content_box);
  tile.box = tile.content_box;
  double childrens = 0.0;
  for (const hlod::NodeId child : hlod_.children(n)) {
    tile.box.take(tiles_[child].box);
    childrens = std::max(childrens, tiles_[child].outer_error());
  }
  const double extent = glm::length(tile.box.max - tile.box.min);
  if (node.children > 0) {
    const double own = error == TileError::guaranteed ? node.guaranteed_error : node.error;
    tile.error = std::max({own, tile.texture_error, above(childrens, extent)});
  }
  double finer = tile.error;
  for (double& coarser : tile.coarser) finer = coarser = std::max(coarser, above(finer, extent));
}

void TileTree::divide(std::size_t own_tiles, std::vector<hlod::NodeId> children, std::uint32_t tiles_per_file,
                      std::uint32_t& extent) {
  std::uint64_t sum = own_tiles;
  for (const hlod::NodeId child : children) sum += tiles_[child].extent;
  std::stable_sort(children.begin(), children.end(),
                   [&](hlod::NodeId a, hlod::NodeId b) { return tiles_[a].extent > tiles_[b].extent; });
  for (const hlod::NodeId child : children) {
    if (sum <= tiles_per_file || tiles_[child].extent == 1) break;
    sum -= tiles_[child].extent - 1;
    tiles_[child].is_external = true;
  }
  extent = static_cast<std::uint32_t>(sum);
}

namespace {

using Json = nlohmann::ordered_json;

// Returns the box as centre and half axes.
Json volume(const TileBox& box) {
  const glm::dvec3 center = 0.5 * box.min + 0.5 * box.max;
  const glm::dvec3 half = glm::max(box.max - center, center - box.min);
  return {{"box", {center.x, center.y, center.z, half.x, 0.0, 0.0, 0.0, half.y, 0.0, 0.0, 0.0, half.z}}};
}

std::string tileset_name(hlod::NodeId n) { return fmt::format("tileset-{}.json", n); }

class JsonWriter {
 public:
  JsonWriter(TilesetFiles& files, const TileTree& tree) : files_(files), tree_(tree) {}

  std::uint64_t run(const std::optional<glm::dmat4>& transform, const std::set<std::string>& images) {
    write("tileset.json", tree_.error(), top(), transform, images);
    for (std::uint64_t written = 1;; ++written) {
      if (externals_.empty()) return written;
      const hlod::NodeId n = externals_.back();
      externals_.pop_back();
      write(tileset_name(n), tree_[n].outer_error(), whole(n), std::nullopt, {});
    }
  }

 private:
  void write(const std::string& name, double error, Json root, const std::optional<glm::dmat4>& transform,
             const std::set<std::string>& images) {
    root["refine"] = "REPLACE";
    if (transform)
      for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) root["transform"].push_back((*transform)[column][row]);
    Json extras = {{"generator", std::string("occlod ") + version()}};
    if (!images.empty()) extras["images"] = images;
    const Json tileset = {{"asset", {{"version", "1.1"}, {"extras", std::move(extras)}}},
                          {"geometricError", error},
                          {"root", std::move(root)}};
    files_.write(name, tileset.dump());
  }

  // Returns the root tile. Several roots become the children of a tile without content.
  Json top() {
    const std::span<const hlod::NodeId> roots = tree_.hlod().data().roots;
    if (roots.size() == 1) return whole(roots[0]);
    Json tile = {{"boundingVolume", volume(tree_.box())}, {"geometricError", tree_.error()}};
    for (const hlod::NodeId n : roots) tile["children"].push_back(part(n));
    return tile;
  }

  Json whole(hlod::NodeId n) {
    const Tile& tile = tree_[n];
    Json json = with_content(n, 0, tile.error);
    for (const hlod::NodeId child : tree_.hlod().children(n)) json["children"].push_back(part(child));
    for (std::size_t i = 0; i < tile.coarser.size(); ++i) {
      Json coarser = with_content(n, i + 1, tile.coarser[i]);
      coarser["children"].push_back(std::move(json));
      json = std::move(coarser);
    }
    return json;
  }

  // Returns one of the tiles of a node, without children.
  Json with_content(hlod::NodeId n, std::size_t coarser, double error) {
    const Tile& tile = tree_[n];
    Json json = {{"boundingVolume", volume(tile.box)}, {"geometricError", error}};
    if (!tile.content_box.is_empty())
      json["content"] = {{"uri", content_name(n, coarser)}, {"boundingVolume", volume(tile.content_box)}};
    return json;
  }

  Json part(hlod::NodeId n) {
    if (!tree_[n].is_external) return whole(n);
    externals_.push_back(n);
    return {{"boundingVolume", volume(tree_[n].box)},
            {"geometricError", tree_[n].outer_error()},
            {"content", {{"uri", tileset_name(n)}}}};
  }

  TilesetFiles& files_;
  const TileTree& tree_;
  std::vector<hlod::NodeId> externals_;  // still to be written
};

}  // namespace

std::string content_name(hlod::NodeId n, std::size_t coarser) {
  constexpr hlod::NodeId files_in_a_folder = 1000;
  const std::string name = fmt::format("tiles/{}/{}", n / files_in_a_folder, n);
  return coarser == 0 ? name + ".glb" : fmt::format("{}-{}.glb", name, coarser);
}

std::uint64_t write_tileset_json(TilesetFiles& files, const TileTree& tree, const std::optional<glm::dmat4>& transform,
                                 const std::set<std::string>& images) {
  return JsonWriter(files, tree).run(transform, images);
}

namespace {

// Holds the sine and cosine of an angle, exact at multiples of 90 degrees.
struct Direction {
  double sine;
  double cosine;
};

Direction direction_of(double degrees) {
  constexpr double radians = 0.017453292519943295;
  if (std::fmod(degrees, 180.0) == 0.0) return {0.0, std::fmod(degrees, 360.0) == 0.0 ? 1.0 : -1.0};
  if (std::fmod(degrees, 90.0) == 0.0) return {degrees > 0.0 ? 1.0 : -1.0, 0.0};  // -90 or 90
  return {std::sin(degrees * radians), std::cos(degrees * radians)};
}

}  // namespace

glm::dmat4 east_north_up(const GeodeticOrigin& origin) {
  constexpr double equator = 6378137.0, flattening = 1.0 / 298.257223563;  // WGS84
  constexpr double squared_eccentricity = flattening * (2.0 - flattening);
  const Direction longitude = direction_of(origin.longitude_deg), latitude = direction_of(origin.latitude_deg);
  const glm::dvec3 east(-longitude.sine, longitude.cosine, 0.0);
  const glm::dvec3 north(-latitude.sine * longitude.cosine, -latitude.sine * longitude.sine, latitude.cosine);
  const glm::dvec3 up(latitude.cosine * longitude.cosine, latitude.cosine * longitude.sine, latitude.sine);
  // The radius runs along the normal from the surface to the axis.
  const double radius = equator / std::sqrt(1.0 - squared_eccentricity * latitude.sine * latitude.sine);
  const glm::dvec3 place((radius + origin.height_m) * up.x, (radius + origin.height_m) * up.y,
                         (radius * (1.0 - squared_eccentricity) + origin.height_m) * up.z);
  return {glm::dvec4(east, 0.0), glm::dvec4(north, 0.0), glm::dvec4(up, 0.0), glm::dvec4(place, 1.0)};
}

}  // namespace occlod::tiles
