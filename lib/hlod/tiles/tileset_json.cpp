#include "hlod/tiles/tileset_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "occlod/core/version.h"

namespace occlod::tiles {
namespace {

using Json = nlohmann::ordered_json;

// Centre and half axes.
Json volume(const TileBox& box) {
  const glm::dvec3 center = 0.5 * box.min + 0.5 * box.max;
  const glm::dvec3 half = glm::max(box.max - center, center - box.min);
  return {{"box", {center.x, center.y, center.z, half.x, 0.0, 0.0, 0.0, half.y, 0.0, 0.0, 0.0, half.z}}};
}

std::string tileset_name(hlod::NodeId n) { return fmt::format("tileset-{}.json", n); }

class JsonWriter {
 public:
  JsonWriter(AtomicFolder& folder, const TileTree& tree) : folder_(folder), tree_(tree) {}

  std::uint64_t run(const std::optional<glm::dmat4>& transform) {
    write("tileset.json", tree_.error(), top(), transform);
    for (std::uint64_t written = 1;; ++written) {
      if (externals_.empty()) return written;
      const hlod::NodeId n = externals_.back();
      externals_.pop_back();
      write(tileset_name(n), tree_[n].error, whole(n), std::nullopt);
    }
  }

 private:
  void write(const std::string& name, double error, Json root, const std::optional<glm::dmat4>& transform) {
    root["refine"] = "REPLACE";
    if (transform)
      for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) root["transform"].push_back((*transform)[column][row]);
    const Json tileset = {
        {"asset", {{"version", "1.1"}, {"extras", {{"generator", std::string("occlod ") + version()}}}}},
        {"geometricError", error},
        {"root", std::move(root)}};
    folder_.write(name, tileset.dump());
  }

  // Several roots are the children of a tile that shows nothing.
  Json top() {
    const std::span<const hlod::NodeId> roots = tree_.hlod().data().roots;
    if (roots.size() == 1) return whole(roots[0]);
    Json tile = {{"boundingVolume", volume(tree_.box())}, {"geometricError", tree_.error()}};
    for (const hlod::NodeId n : roots) tile["children"].push_back(part(n));
    return tile;
  }

  Json whole(hlod::NodeId n) {
    const Tile& tile = tree_[n];
    Json json = {{"boundingVolume", volume(tile.box)}, {"geometricError", tile.error}};
    if (!tile.content_box.is_empty())
      json["content"] = {{"uri", content_name(n)}, {"boundingVolume", volume(tile.content_box)}};
    for (const hlod::NodeId child : tree_.hlod().children(n)) json["children"].push_back(part(child));
    return json;
  }

  Json part(hlod::NodeId n) {
    if (!tree_[n].is_external) return whole(n);
    externals_.push_back(n);
    return {{"boundingVolume", volume(tree_[n].box)},
            {"geometricError", tree_[n].error},
            {"content", {{"uri", tileset_name(n)}}}};
  }

  AtomicFolder& folder_;
  const TileTree& tree_;
  std::vector<hlod::NodeId> externals_;  // still to be written
};

}  // namespace

std::string content_name(hlod::NodeId n) {
  constexpr hlod::NodeId files_in_a_folder = 1000;
  return fmt::format("tiles/{}/{}.glb", n / files_in_a_folder, n);
}

std::uint64_t write_tileset_json(AtomicFolder& folder, const TileTree& tree,
                                 const std::optional<glm::dmat4>& transform) {
  return JsonWriter(folder, tree).run(transform);
}

}  // namespace occlod::tiles
