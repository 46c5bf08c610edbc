// Implements what `occlod cells build|merge|pack|info|validate|walk` share.
#include "cells.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/timing.h"
#include "commands.h"
#include "drawing.h"
#include "option_names.h"
#include "render_input.h"

namespace occlod::tool {
namespace {

Json options_to_json(const CellTreeOptions& options) {
  const EyeModel& eyes = options.cell.eyes;
  Json regions = Json::array();
  for (const CellBox& region : options.regions)
    regions.push_back({{"min", to_json(region.min)}, {"max", to_json(region.max)}});
  return {{"tolerance_px", options.cell.tolerance_px},
          {"budget", options.cell.budget},
          {"occlusion", name_of(options.cell.occlusion)},
          {"focal_length_px", eyes.focal_length_px},
          {"cos_corner_angle", eyes.cos_corner_angle},
          {"near", eyes.near},
          {"occluder_motion", options.occluder_motion.value_or(0.0)},
          {"root_cell", options.root_cell},
          {"smallest_cell", options.smallest_cell},
          {"max_triangles", options.max_triangles},
          {"division", name_of(options.division)},
          {"regions", regions}};
}

// Describes what the leaves draw.
Json cells_to_json(const VlodFile& file) {
  const CellTree& tree = file.tree();
  const double most = static_cast<double>(file.options().max_triangles);
  std::vector<double> drawn, active, above;
  double error_px = 0.0;
  std::uint32_t depth = 0;
  for (CellId n = 0; n < tree.nodes().size(); ++n) {
    const CellNode& node = tree.node(n);
    if (!tree.is_leaf(n)) continue;
    depth = std::max(depth, node.level);
    drawn.push_back(node.drawn_triangles);
    active.push_back(node.triangles);
    error_px = std::max(error_px, static_cast<double>(node.error_px));
    if (drawn.back() > most && most > 0.0) above.push_back(drawn.back() / most);
  }
  const auto mean = [](const std::vector<double>& values) {
    return values.empty() ? 0.0
                          : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  };
  return {{"cells", tree.leaf_count()},
          {"nodes", tree.nodes().size()},
          {"depth", depth},
          {"above_most_triangles", static_cast<double>(above.size()) / static_cast<double>(drawn.size())},
          {"above_by", mean(above)},
          {"drawn_mean", mean(drawn)},
          {"drawn_median", median(drawn)},
          {"drawn_max", *std::max_element(drawn.begin(), drawn.end())},
          {"triangles_mean", mean(active)},
          {"error_px", error_px}};
}

struct PathBytes {
  double teleport_max = 0.0;   // to read a whole path
  double crossing_mean = 0.0;  // to move from a cell to a neighbour
  double crossing_max = 0.0;
};

PathBytes path_bytes(const CellTree& tree) {
  std::vector<double> to_root(tree.nodes().size());
  for (CellId n = 0; n < tree.nodes().size(); ++n)
    to_root[n] = tree.node(n).payload_bytes + (n == 0 ? 0.0 : to_root[tree.node(n).parent]);
  PathBytes bytes;
  double crossings = 0.0;
  std::vector<CellId> neighbours;
  for (CellId n = 0; n < tree.nodes().size(); ++n) {
    if (!tree.is_leaf(n)) continue;
    bytes.teleport_max = std::max(bytes.teleport_max, to_root[n]);
    tree.neighbours(n, neighbours);
    for (const CellId next : neighbours) {
      const double read = to_root[next] - to_root[tree.common_ancestor(std::min(n, next), std::max(n, next))];
      bytes.crossing_max = std::max(bytes.crossing_max, read);
      bytes.crossing_mean += read;
      crossings += 1.0;
    }
  }
  if (crossings > 0.0) bytes.crossing_mean /= crossings;
  return bytes;
}

Json bytes_to_json(const VlodFile& file) {
  std::uint64_t payload = 0, splits = 0, candidates = 0, hidden = 0;
  for (const CellNode& node : file.tree().nodes()) {
    payload += node.payload_bytes;
    splits += node.splits;
    candidates += node.candidates;
    hidden += node.hidden_faces;
  }
  const PathBytes paths = path_bytes(file.tree());
  const auto ids = static_cast<double>(splits + hidden);
  return {{"splits", splits},
          {"candidates", candidates},
          {"hidden_faces", hidden},
          {"file_bytes", file.file_bytes()},
          {"payload_bytes", payload},
          {"bytes_per_cell", static_cast<double>(file.file_bytes()) / file.tree().leaf_count()},
          {"bits_per_id", ids > 0.0 ? 8.0 * static_cast<double>(payload) / ids : 0.0},
          {"teleport_bytes_max", paths.teleport_max},
          {"crossing_bytes_mean", paths.crossing_mean},
          {"crossing_bytes_max", paths.crossing_max}};
}

Json geometry_to_json(const PackedCounts& counts) {
  return {{"geometry_splits", counts.splits},
          {"geometry_bytes", counts.bytes},
          {"geometry_raw_bytes", counts.raw_bytes},
          {"geometry_frames", counts.frames}};
}

}  // namespace

CellScene load_cell_scene(const SceneDescription& scene, const std::filesystem::path& file, bool use_cache) {
  CellScene result;
  result.loaded = load_objects_of(scene, file.parent_path(), use_cache);
  result.objects = refine_objects(result.loaded);
  for (const LoadedObject& object : result.loaded) result.names.push_back(object.source_name);
  return result;
}

std::size_t hierarchy_bytes(std::span<const RefineObject> objects) {
  std::set<const Hierarchy*> counted;
  std::size_t bytes = 0;
  for (const RefineObject& object : objects)
    if (counted.insert(object.hierarchy).second) bytes += object.hierarchy->bytes();
  return bytes;
}

std::optional<std::vector<double>> numbers_in(const std::string& text, std::size_t count) {
  std::vector<double> numbers;
  for (const std::string& part : CLI::detail::split(text, ',')) {
    double number = 0.0;
    if (!CLI::detail::lexical_cast(part, number) || !std::isfinite(number)) return {};
    numbers.push_back(number);
  }
  return numbers.size() == count ? std::optional(numbers) : std::nullopt;
}

Json to_json(const VlodFile& file) {
  Json told = options_to_json(file.options());
  told["objects"] = file.object_count();
  told.update(cells_to_json(file));
  told.update(bytes_to_json(file));
  told["packed"] = file.is_packed();
  if (file.is_packed()) told.update(geometry_to_json(file.packed_counts()));
  return told;
}

void add_cells(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("cells", "View cells: what to draw wherever the eye is in a box of space");
  command.require_subcommand(1);
  add_cells_build(command);
  add_cells_merge(command);
  add_cells_pack(command);
  add_cells_info(command);
  add_cells_validate(command);
  add_cells_walk(command);
  command.footer(
      "For example:\n"
      "  occlod cells build city.json -o city.vlod\n"
      "  occlod cells info city.vlod --cell 100,200,1.7");
}

}  // namespace occlod::tool
