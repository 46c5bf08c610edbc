// Implements `occlod cells build SCENE -o FILE.vlod`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "cells.h"
#include "chosen_views.h"
#include "command_files.h"
#include "global_options.h"
#include "interrupt.h"
#include "occlod/base.h"
#include "occlod/build_cells.h"
#include "option_values.h"
#include "peak_bytes.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

constexpr double min_length = 1e-6, max_length = 1e12;  // world units
constexpr double min_px = 1e-6;
constexpr std::uint64_t max_drawn = 1'000'000'000'000, max_shards = 1'000'000;
constexpr std::uint32_t roots_in_part = 16;  // per file in --work, which bounds the loss when a build stops

struct Shard {
  std::uint32_t index = 0;  // from 0
  std::uint32_t count = 1;
};

struct Options {
  std::filesystem::path file, output, work;
  CellTreeOptions tree;
  std::vector<CellBox> regions;  // replace the scene's
  std::optional<double> root_cell, smallest_cell;
  std::optional<std::uint64_t> max_triangles;
  std::optional<Shard> shard;
  bool use_cache = true;
  int threads = 0;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

Shard parse_shard(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto index = whole_number(text.substr(0, slash));
  const auto count = slash == std::string::npos ? std::nullopt : whole_number(text.substr(slash + 1));
  if (!index || !count || *index < 1 || *index > *count || *count > max_shards)
    throw CLI::ValidationError("--shard", fmt::format("{} is not I/N with 1 <= I <= N <= {}", shown(text), max_shards));
  return {static_cast<std::uint32_t>(*index - 1), static_cast<std::uint32_t>(*count)};
}

CellBox parse_region(const std::string& text) {
  const auto n = numbers_in(text, 6);
  if (!n || (*n)[0] > (*n)[3] || (*n)[1] > (*n)[4] || (*n)[2] > (*n)[5])
    throw CLI::ValidationError(
        "--region",
        fmt::format("{} is not X,Y,Z,X,Y,Z: the corner with the smallest and that with the largest coordinates",
                    shown(text)));
  return {{(*n)[0], (*n)[1], (*n)[2]}, {(*n)[3], (*n)[4], (*n)[5]}};
}

EyeModel parse_image(const std::string& text) {
  const std::size_t comma = text.find(',');
  const auto size = parse_size(text.substr(0, comma));
  const auto numbers = comma == std::string::npos ? std::nullopt : numbers_in(text.substr(comma + 1), 2);
  if (!size || !numbers || !((*numbers)[0] > 0.0) || !((*numbers)[0] < 180.0) || !((*numbers)[1] > 0.0))
    throw CLI::ValidationError(
        "--image", fmt::format("{} is not WIDTHxHEIGHT,FOV,NEAR: pixels, degrees from top to bottom (below 180), and a "
                               "distance above 0",
                               shown(text)));
  Camera camera;
  camera.eye = {0, 0, 0};
  camera.target = {1, 0, 0};
  camera.width = size->width;
  camera.height = size->height;
  camera.fov_y_deg = (*numbers)[0];
  camera.near = (*numbers)[1];
  camera.far = 2.0 * camera.near;
  return eye_model(View(camera));
}

// The command line takes precedence over the scene, and the scene over the defaults.
CellTreeOptions chosen_options(const Options& options, const SceneDescription& scene) {
  CellTreeOptions chosen = options.tree;
  const SceneCells in_scene = scene.cells.value_or(SceneCells{});
  chosen.regions = options.regions.empty() ? in_scene.regions : options.regions;
  if (chosen.regions.empty())
    throw Error({options.file.string(), "cells", "does not say where the eye may be",
                 "give boxes by --region, or by the key cells of a scene"});
  const CellTreeOptions usual;
  chosen.root_cell = options.root_cell.value_or(in_scene.root_cell.value_or(usual.root_cell));
  chosen.smallest_cell = options.smallest_cell.value_or(in_scene.smallest_cell.value_or(usual.smallest_cell));
  chosen.max_triangles = options.max_triangles.value_or(in_scene.max_triangles.value_or(usual.max_triangles));
  return chosen;
}

void check(const Options& options, CommandFiles& files) {
  if (options.shard && options.work.empty())
    throw CLI::ValidationError("--shard", "needs --work: the folder for its part");
  if (options.shard && !options.output.empty())
    throw CLI::ValidationError("--shard", "makes parts; leave --output out and merge them with 'occlod cells merge'");
  if (!options.shard && options.output.empty()) throw CLI::ValidationError("--output", "is required without --shard");
  files.add_input("the input", options.file);
  if (!options.output.empty()) files.add_output("--output", options.output, ".vlod");
}

// Builds and writes, and counts the work.
class Building {
 public:
  Building(const Options& options, const CellScene& scene, const CellTreeOptions& tree)
      : options_(options), build_(scene.objects, tree), progress_(options.progress) {}

  void write_file() {
    const auto show = shown_as("building " + options_.output.string(), 0, build_.root_cell_count());
    write_interruptibly(options_.output.string(), 0, progress_,
                        [&] { build_.write(options_.output, options_.threads, show); });
  }

  // Writes all parts of the shard, or of everything, and returns their files, which it adds to those of the command.
  std::vector<std::filesystem::path> write_parts(CommandFiles& files) {
    std::error_code error;
    std::filesystem::create_directories(options_.work, error);
    if (error)
      throw Error({options_.work.string(), "--work", fmt::format("cannot be made: {}", error.message()),
                   "name another folder"});
    const Shard shard = options_.shard.value_or(Shard{});
    const CellRange all = build_.shard(shard.index, shard.count);
    std::vector<CellRange> ranges;
    std::vector<std::filesystem::path> parts;
    for (std::uint32_t first = all.first; first < all.first + all.count; first += roots_in_part) {
      ranges.push_back({first, std::min(roots_in_part, all.first + all.count - first)});
      parts.push_back(options_.work / build_.part_name(ranges.back()));
      files.add_output("--work", parts.back());
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (build_.has_part(parts[i], ranges[i])) {
        ++found_;
        continue;
      }
      const auto show = shown_as("building " + options_.work.string(), ranges[i].first - all.first, all.count);
      write_interruptibly(parts[i].string(), 0, progress_,
                          [&] { build_.write_part(parts[i], ranges[i], options_.threads, show); });
      has_written_ = true;
    }
    return parts;
  }

  void merge(const std::vector<std::filesystem::path>& parts) {
    write_interruptibly(options_.output.string(), 0, progress_, [&] { merge_cells(parts, options_.output); });
  }

  [[nodiscard]] Json counts(const std::vector<std::filesystem::path>& parts) const {
    Json counts = {{"root_cells", build_.root_cell_count()}, {"cuts", build_.cuts()}};
    if (!options_.work.empty()) {
      counts["parts"] = parts.size();
      counts["parts_found"] = found_;
    }
    return counts;
  }
  void clear() { progress_.clear(); }

 private:
  // `done` of `all` root cells are already done.
  std::function<bool(double)> shown_as(const std::string& what, std::uint32_t done, std::uint32_t all) {
    const std::uint32_t here = options_.work.empty() ? all : std::min(roots_in_part, all - done);
    return [this, what, done, all, here](double share) {
      // Once a file was begun, signals are only recorded.
      if (has_written_) note_interrupts();
      progress_.show(what, (done + share * here) / all);
      return true;
    };
  }

  const Options& options_;
  CellBuild build_;
  Progress progress_;
  std::size_t found_ = 0;
  bool has_written_ = false;
};

void run(const Options& options) {
  handle_interrupts("cells build");
  const SceneDescription description = describe_file(options.file);
  CommandFiles files;
  check(options, files);
  const CellTreeOptions tree = chosen_options(options, description);
  const CellScene scene = load_cell_scene(description, options.file, options.use_cache);
  const Stopwatch stopwatch;
  const std::clock_t cpu = std::clock();
  Building building(options, scene, tree);
  std::vector<std::filesystem::path> parts;
  if (options.work.empty()) {
    building.write_file();
  } else {
    parts = building.write_parts(files);
    if (!options.shard) building.merge(parts);
  }
  building.clear();
  const double cpu_s = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;

  Json result = {{"input", options.file.string()}};
  if (options.output.empty())
    result["work"] = options.work.string();
  else
    result["file"] = options.output.string();
  result.update(building.counts(parts));
  const glm::dvec3 origin = scene.objects[0].hierarchy->data().origin;
  if (std::ranges::all_of(scene.objects, [&](const RefineObject& o) { return o.hierarchy->data().origin == origin; }))
    add_origin(result, origin);
  if (!options.output.empty()) {
    const auto file = open_vlod(options.output);
    result.update(to_json(*file));
    const auto bytes = hierarchy_bytes(scene.objects);
    result["hierarchy_bytes"] = bytes;
    result["bytes_over_hierarchies"] = static_cast<double>(file->file_bytes()) / static_cast<double>(bytes);
    result["cpu_s_per_cell"] = cpu_s / file->tree().leaf_count();
  }
  result["cpu_s"] = cpu_s;
  result["build_ms"] = stopwatch.milliseconds();
  result["peak_bytes"] = peak_bytes();
  if (options.json) return print_json(result);
  print_lines(result);
}

template <typename Set>
void add_text(CLI::App& command, const std::string& name, const char* type, const std::string& about, const Set& set) {
  command.add_option_function<std::string>(name, set, about)->type_name(type);
}

void add_space_options(CLI::App& command, const std::shared_ptr<Options>& options) {
  command
      .add_option_function<std::vector<std::string>>(
          "--region",
          [options](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) options->regions.push_back(parse_region(text));
          },
          "A box in which the eye may be, instead of those of the scene; may be given several times")
      ->type_name("X,Y,Z,X,Y,Z")
      ->allow_extra_args(false);
  add_number(command, "--root-cell", options->root_cell, RealRange{min_length, max_length},
             "Longest edge of a cell before it is divided, world units; else what the scene says, or 16");
  add_number(command, "--smallest-cell", options->smallest_cell, RealRange{min_length, max_length},
             "No edge becomes shorter, world units; else what the scene says, or 1");
  add_number(command, "--max-triangles", options->max_triangles, WholeRange{0, max_drawn},
             "Divide a cell that draws more; else what the scene says, or 200000");
}

}  // namespace

void add_cells_build(CLI::App& cells) {
  CLI::App& command = *cells.add_subcommand("build", "Divide space into cells and find what to draw in each");
  const auto options = std::make_shared<Options>();
  add_file(command, "INPUT", options->file, "A scene (.json), a mesh, or a hierarchy (.olod)")->required();
  add_file(command, "-o,--output", options->output, "File to write, .vlod");
  add_number(command, "--tolerance", options->tree.cell.tolerance_px, RealRange{min_px},
             "Largest error on the screen that may stay, in pixels")
      ->capture_default_str();
  add_number(command, "--budget", options->tree.cell.budget, WholeRange{1, max_drawn},
             "Triangles of a cell's meshes, drawn or not, at most: then it may be off by more than --tolerance")
      ->option_text("N");
  add_choice(command, "--occlusion", options->tree.cell.occlusion,
             {{"none", CellOcclusion::none}, {"hull", CellOcclusion::hull}, {"sampled", CellOcclusion::sampled}},
             "hull: leave out what is hidden from all of a cell; sampled: what 125 eyes do not see, which may miss "
             "something; none: leave out nothing that is hidden");
  add_text(command, "--image", "WxH,FOV,NEAR",
           "Image, field of view from top to bottom and near plane of all eyes [1024x768,60,0.01]",
           [options](const std::string& text) { options->tree.cell.eyes = parse_image(text); });
  add_space_options(command, options);
  add_file(command, "--work", options->work,
           "Keep what is done in parts in this folder, and build only parts that are not there, or damaged")
      ->type_name("FOLDER");
  add_text(command, "--shard", "I/N", "Build the I-th of N shares of all cells, as parts in --work",
           [options](const std::string& text) { options->shard = parse_shard(text); });
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json,
                                  .progress = &options->progress,
                                  .threads = &options->threads,
                                  .use_cache = &options->use_cache});
    run(*options);
  });
}

}  // namespace occlod::tool
