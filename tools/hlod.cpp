// Implements `occlod hlod build|info|validate|render`.
#include "hlod.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "base/timing.h"
#include "commands.h"
#include "hlod/build/build_journal.h"
#include "occlod/base.h"
#include "occlod/mesh_file.h"
#include "occlod/scene.h"
#include "option_values.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

constexpr std::uint64_t min_node_triangles = 16, max_node_triangles = 4096;

Json level_of(const hlod::Hlod& hlod, std::size_t index) {
  const hlod::Level& level = hlod.data().levels[index];
  std::uint64_t triangles = 0, vertices = 0, parents = 0, children = 0;
  float guaranteed_error = 0.0F;
  std::vector<float> errors;
  for (hlod::NodeId n = level.first_node; n < level.first_node + level.node_count; ++n) {
    const hlod::Node& node = hlod.node(n);
    triangles += node.triangles;
    vertices += node.vertices;
    const bool is_root = node.patches == 0 || hlod.patches(n)[0].parent == no_id;
    parents += is_root ? 0U : node.patches;
    children += node.children;
    errors.push_back(node.error);
    guaranteed_error = std::max(guaranteed_error, node.guaranteed_error);
  }
  const double nodes = level.node_count;
  return {{"level", index},
          {"nodes", level.node_count},
          {"triangles", triangles},
          {"vertices", vertices},
          {"parents", static_cast<double>(parents) / nodes},
          {"children", static_cast<double>(children) / nodes},
          {"error_median", median(errors)},
          {"error_max", *std::max_element(errors.begin(), errors.end())},
          {"guaranteed_error", guaranteed_error}};
}

SceneDescription describe_all(const std::vector<std::string>& files) {
  SceneDescription all;
  all.name = files.front();
  for (const std::string& file : files) {
    SceneDescription scene = describe_file(file);
    // Names in a scene file are relative to its folder, and each file has its own folder.
    for (SceneObject& object : scene.objects)
      if (auto* source = std::get_if<MeshFile>(&object.source))
        for (std::string& name : source->names)
          if (const auto found = find_mesh(name, std::filesystem::path(file).parent_path()); !found.empty())
            name = std::filesystem::absolute(found).string();
    std::move(scene.objects.begin(), scene.objects.end(), std::back_inserter(all.objects));
  }
  return all;
}

}  // namespace

CleanMesh read_hlod_input(const std::vector<std::string>& files, Progress& progress) {
  if (files.size() == 1 && !is_scene_file(files[0]))
    return read_mesh(files[0], [&](double done) {
      if (done < 1.0)
        progress.show("reading " + files[0], done);
      else
        progress.show("cleaning " + files[0], std::nullopt);
    });
  return flatten_scene(describe_all(files), std::filesystem::path(files[0]).parent_path(),
                       [&](const std::string& what, double done) { progress.show(what, done); });
}

hlod::TriangleSource stream_hlod_input(const std::vector<std::string>& files, Progress& progress) {
  return stream_scene(describe_all(files), std::filesystem::path(files[0]).parent_path(),
                      [&](const std::string& what, double done) { progress.show(what, done); });
}

OhlodFile read_nested_ohlod(const std::string& file) {
  OhlodFile read = read_ohlod(file);
  if (read.hlod.data().grouping != hlod::Grouping::nested)
    throw Error({file, "", "has shifted groups, whose nodes have several parents, and tiles form a tree",
                 "build it with --grouping nested --borders free"});
  return read;
}

void add_node_triangles(CLI::App& command, std::uint32_t& node_triangles) {
  add_number(command, "--node-triangles", node_triangles, WholeRange{min_node_triangles, max_node_triangles},
             "The most triangles that a node of the finest level has")
      ->capture_default_str();
}

BuiltHlod build_from_files(const std::vector<std::string>& files, bool streams, const hlod::HlodBuildOptions& options,
                           Progress& progress, const OnEarth& on_earth) {
  BuiltHlod built;
  if (streams) {
    hlod::TriangleSource source = stream_hlod_input(files, progress);
    if (on_earth.system != nullptr) source = brought(std::move(source), *on_earth.system, on_earth.up);
    built.hlod = build_hlod(source, options, built.report, built.nodes_found);
    return built;
  }
  const Stopwatch stopwatch;
  CleanMesh input = read_hlod_input(files, progress);
  built.read_ms = stopwatch.milliseconds();
  if (on_earth.system != nullptr) input = brought(std::move(input), *on_earth.system, on_earth.up, options.threads);
  built.report = input.report;
  built.hlod = build_hlod(input.mesh, options, built.report, built.nodes_found);
  return built;
}

Json counts_of(const hlod::Hlod& hlod) {
  const hlod::HlodView& view = hlod.data();
  std::uint64_t stored = 0;
  for (const hlod::Node& node : view.nodes) stored += node.triangles;
  Json counts = {{"triangles", view.input_triangle_count},
                 {"nodes", view.nodes.size()},
                 {"levels", view.levels.size()},
                 {"roots", view.roots.size()},
                 {"patches", view.patches.size()},
                 {"stored_triangles", stored},
                 {"grouping", view.grouping == hlod::Grouping::nested ? "nested" : "shifted"},
                 {"borders", view.borders == hlod::Borders::free ? "free" : "locked"},
                 {"node_triangles", view.node_triangles},
                 {"within", view.within.empty() ? "geomorph" : "splits"}};
  add_origin(counts, view.origin);
  if (view.lattice_step > 0.0F) counts["lattice_step"] = view.lattice_step;
  if (!view.within.empty()) {
    std::uint64_t splits = 0;
    for (const hlod::NodeWithin& within : view.within) splits += within.splits;
    counts["splits"] = splits;
    counts["within_bytes"] = view.within.size_bytes() + view.splits.size_bytes();
  }
  counts["bytes"] = hlod.bytes();
  counts["bytes_per_triangle"] = static_cast<double>(hlod.bytes()) / static_cast<double>(view.input_triangle_count);
  return counts;
}

Json file_size_of(const std::string& file, const hlod::Hlod& hlod) {
  const std::uintmax_t bytes = std::filesystem::file_size(file);
  return {
      {"file_bytes", bytes},
      {"file_bytes_per_triangle", static_cast<double>(bytes) / static_cast<double>(hlod.data().input_triangle_count)}};
}

Json levels_of(const hlod::Hlod& hlod) {
  Json levels = Json::array();
  for (std::size_t level = 0; level < hlod.level_count(); ++level) levels.push_back(level_of(hlod, level));
  return levels;
}

void print_levels(const Json& levels) {
  fmt::print("\n{:>5} {:>8} {:>11} {:>8} {:>8} {:>12} {:>12} {:>12}\n", "level", "nodes", "triangles", "parents",
             "children", "error median", "error max", "guaranteed");
  for (const Json& level : levels)
    fmt::print("{:>5} {:>8} {:>11} {:>8.2f} {:>8.2f} {:>12.4g} {:>12.4g} {:>12.4g}\n", level["level"].get<int>(),
               level["nodes"].get<std::uint64_t>(), level["triangles"].get<std::uint64_t>(),
               level["parents"].get<double>(), level["children"].get<double>(), level["error_median"].get<double>(),
               level["error_max"].get<double>(), level["guaranteed_error"].get<double>());
}

void add_hlod(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("hlod", "Hierarchical levels of detail: nodes of some thousand triangles");
  command.require_subcommand(1);
  add_hlod_build(command);
  add_hlod_info(command);
  add_hlod_validate(command);
  add_hlod_render(command);
  command.footer(
      "For example:\n"
      "  occlod hlod build city.json -o city.ohlod\n"
      "  occlod hlod render city.ohlod --scene city.json --path walk");
}

}  // namespace occlod::tool
