// Implements `occlod hlod build INPUT... -o FILE.ohlod`, or `--clusters N -o FILE.glb`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command_files.h"
#include "global_options.h"
#include "hlod.h"
#include "hlod_clusters.h"
#include "interrupt.h"
#include "mesh/image_files.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/node_store.h"
#include "option_values.h"
#include "peak_bytes.h"
#include "standard_streams.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

constexpr int min_bits = 8, max_bits = 23;
constexpr std::uint64_t min_cluster_triangles = 32, max_cluster_triangles = 256;

enum class Packing { none, zstd, meshopt };

struct Options {
  std::vector<std::string> inputs;
  std::string output;
  hlod::HlodBuildOptions build;
  std::uint32_t clusters = 0;      // the most triangles of one; 0: nodes
  std::optional<Packing> packing;  // nothing: zstd for nodes, none for clusters
  std::optional<std::size_t> memory;
  std::string scratch;
  bool resume = false;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

std::string journal_of(const Options& options) { return options.output + ".journal"; }
std::string images_journal_of(const Options& options) { return options.output + ".images.journal"; }

hlod::HlodBuildOptions build_options(const Options& options, Progress& progress) {
  hlod::HlodBuildOptions build = options.build;
  if (options.resume) build.journal = journal_of(options);
  build.progress = [&progress, what = "building " + options.output](double done) {
    progress.show(what, done);
    return true;
  };
  return build;
}

void check(const Options& options, CommandFiles& files) {
  if (options.build.grouping == hlod::Grouping::shifted && options.build.borders == hlod::Borders::free)
    throw CLI::ValidationError("--borders", "free needs --grouping nested: shifted groups are there to have no gaps");
  for (const std::string& input : options.inputs) files.add_input("an input", input);
  files.add_output("--output", options.output, options.clusters > 0 ? ".glb" : ".ohlod");
  if (options.packing == (options.clusters > 0 ? Packing::zstd : Packing::meshopt))
    throw CLI::ValidationError("--compress", "meshopt and --clusters go together, as zstd and .ohlod do");
  if (options.resume)
    for (const std::string& journal : {journal_of(options), images_journal_of(options)})
      files.add_output("--resume", journal);
  if (options.memory && options.build.within == hlod::Within::splits)
    throw CLI::ValidationError("--memory", "goes with --within geomorph only: splits of all nodes are kept in memory");
}

std::filesystem::path scratch_folder(const Options& options) {
  if (!options.scratch.empty()) return options.scratch;
  const std::filesystem::path folder = std::filesystem::path(options.output).parent_path();
  return folder.empty() ? "." : folder;  // it needs room for the result anyway
}

void remove_journal(const std::string& file) {
  std::error_code error;
  std::filesystem::remove(file, error);
  if (error) throw Error({file, "", "cannot be removed: " + error.message(), "remove it: the build is finished"});
}

void run(const Options& options) {
  handle_interrupts("hlod build");
  CommandFiles files;
  check(options, files);
  Progress progress(options.progress);
  if (options.clusters > 0) {
    const bool compresses = options.packing == Packing::meshopt;
    return build_clusters({options.inputs, options.output, options.clusters, options.build.error_bound, compresses,
                           options.build.threads},
                          progress, options.json);
  }
  Stopwatch stopwatch;
  std::optional<MemoryLimit> limit;
  if (options.memory) limit.emplace(*options.memory, scratch_folder(options));
  const BuiltHlod built =
      build_from_files(options.inputs, limit.has_value(), build_options(options, progress), progress);
  const double build_ms = stopwatch.restart();
  OhlodOptions file;
  if (options.packing == Packing::none) file.compression = OlodCompression::none;
  file.images = OhlodImages::nodes;
  file.image_folder = folder_of(options.inputs[0]);
  file.threads = options.build.threads;
  if (options.resume) file.images_journal = images_journal_of(options);
  file.images_progress = [&](double done) {
    note_interrupts();
    progress.show("making images of " + options.output, done);
  };
  write_interruptibly(options.output, built.hlod.bytes(), progress,
                      [&] { write_ohlod(options.output, built.hlod, built.report, file); });
  if (options.resume)
    for (const std::string& journal : {images_journal_of(options), journal_of(options)}) remove_journal(journal);
  if (options.build.within == hlod::Within::splits && !built.hlod.data().textures.empty())
    print_note("nodes have no images of their own, as without --within splits: pictures show those of the input");
  const double write_ms = stopwatch.milliseconds();
  progress.clear();

  Json result = {{"inputs", options.inputs}, {"file", options.output}};
  result.update(counts_of(built.hlod));
  result.update(file_size_of(options.output, built.hlod));
  if (!limit) result["read_ms"] = built.read_ms;
  result["build_ms"] = build_ms - built.read_ms;
  result["write_ms"] = write_ms;
  result["triangles_per_s"] =
      1e3 * static_cast<double>(built.hlod.data().input_triangle_count) / (build_ms - built.read_ms);
  result["peak_bytes"] = peak_bytes();
  if (limit) result["scratch_bytes"] = limit->max_scratch_bytes();
  if (options.resume) result["nodes_found"] = built.nodes_found;
  result["report"] = to_json(built.report);
  if (options.json) return print_json(result);
  print_lines(result);
  print_lines(built.report);
}

}  // namespace

void add_hlod_build(CLI::App& hlod) {
  CLI::App& command = *hlod.add_subcommand("build", "Build the nodes of a scene, a mesh, or several meshes");
  const auto options = std::make_shared<Options>();
  add_file(command, "INPUT", options->inputs, "A scene (.json) or meshes (.ply, .obj, .off, .stl, .gltf or .glb)")
      ->required();
  add_file(command, "-o,--output", options->output, "File to write, .ohlod; with --clusters .glb")->required();
  add_node_triangles(command, options->build.node_triangles);
  add_choice(command, "--grouping", options->build.grouping,
             {{"shifted", hlod::Grouping::shifted}, {"nested", hlod::Grouping::nested}},
             "shifted: borders move from level to level, so that no gap opens and none stays fine; nested: one octree");
  add_choice(command, "--borders", options->build.borders,
             {{"locked", hlod::Borders::locked}, {"free", hlod::Borders::free}},
             "locked: vertices that nodes share stay; free: neighbours of different levels leave gaps (nested only)");
  add_choice(command, "--within", options->build.within,
             {{"geomorph", hlod::Within::geomorph}, {"splits", hlod::Within::splits}},
             "geomorph: vertices can slide to the coarser level; splits: also keep each node's collapses, so that its "
             "error can be anything between two levels, for about twice the bytes");
  add_choice(
      command, "--error-bound", options->build.error_bound,
      {{"accumulated", ErrorBound::accumulated}, {"measured", ErrorBound::measured}},
      "Guaranteed errors, by which tilesets are refined: accumulated (loose) or measured (tight, about twice the "
      "build time)");
  command
      .add_option_function<int>(
          "--quantise",
          [options](int bits) {
            if (bits > 0 && bits < min_bits)
              throw CLI::ValidationError("--quantise",
                                         fmt::format("{} is not 0 or in [{}, {}]", bits, min_bits, max_bits));
            options->build.quantise_bits = bits;
          },
          "Round positions to a lattice of so many bits for the longest side of the box, for smaller files. "
          "Errors are then relative to the rounded mesh; 0: as they are")
      ->transform(in_range(WholeRange{0, max_bits}))
      ->type_name("N");
  using Packed = std::optional<Packing>;
  add_choice(command, "--compress", options->packing,
             {{"none", Packed(Packing::none)}, {"zstd", Packed(Packing::zstd)}, {"meshopt", Packed(Packing::meshopt)}},
             "zstd, the default: meshes of nodes take half the bytes or less, none of them lost, and are unpacked one "
             "by one when used; none, that of --clusters: the file is mapped into memory when used; meshopt, with "
             "--clusters: by EXT_meshopt_compression, without loss");
  add_memory(command, options->memory, min_build_memory,
             "Stream the input and keep to so much main memory, e.g. 1G: what does not fit lies in scratch files. The "
             "result does not depend on how much. Not with --within splits, which keeps all nodes in memory");
  add_file(command, "--scratch", options->scratch, "With --memory: folder for scratch files; else that of the output")
      ->type_name("FOLDER")
      ->needs("--memory");
  command.add_flag(
      "--resume", options->resume,
      "Keep finished nodes in OUTPUT.journal, and their images in OUTPUT.images.journal, until the output is "
      "there. A build that was killed goes on from them when the same command runs again");
  CLI::Option* const clusters =
      add_number(command, "--clusters", options->clusters, WholeRange{min_cluster_triangles, max_cluster_triangles},
                 "Make clusters of at most so many triangles and 256 vertices for other renderers, as meshoptimizer's "
                 "clusterlod.h "
                 "does, on levels that halve, as arrays in a .glb file. 128 suits mesh shaders");
  for (const char* other :
       {"--node-triangles", "--grouping", "--borders", "--within", "--quantise", "--memory", "--resume"})
    clusters->excludes(command.get_option(other));
  command.callback([options, &command] {
    read_global_options(command,
                        {.json = &options->json, .progress = &options->progress, .threads = &options->build.threads});
    run(*options);
  });
}

}  // namespace occlod::tool
