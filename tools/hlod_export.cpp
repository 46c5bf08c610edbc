// Implements `occlod hlod export FILE.ohlod -o FOLDER`: 3D Tiles 1.1 with glTF contents.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "base/text.h"
#include "command_files.h"
#include "global_options.h"
#include "hlod.h"
#include "hlod/tiles/tile_tree.h"
#include "interrupt.h"
#include "mesh/image_files.h"
#include "occlod/base.h"
#include "occlod/node_store.h"
#include "occlod/tiles.h"
#include "option_values.h"
#include "peak_bytes.h"
#include "standard_streams.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

constexpr std::uint64_t max_tiles_per_file = 1'000'000;
constexpr int min_bits = 8, max_bits = 16;

struct Options {
  std::string file;
  std::string folder;
  std::string origin;
  std::string images;
  tiles::TilesetOptions tileset;
  std::uint32_t tiles_per_file = tiles::usual_tiles_per_file;
  ShowProgress progress = ShowProgress::automatic;
  bool json = false;
};

// Parses LON,LAT,H.
tiles::GeodeticOrigin parse_origin(const std::string& text) {
  const auto fail = [&] {
    throw CLI::ValidationError("--origin", shown(text) +
                                               " is no place: give longitude in [-180, 180] and latitude in [-90, 90] "
                                               "in degrees, and metres above the ellipsoid, as in 11.5,48.1,520");
  };
  std::vector<double> numbers;
  for (std::size_t first = 0; first <= text.size();) {
    const std::size_t end = std::min(text.find(',', first), text.size());
    const char* const last = text.data() + end;
    const auto [after, error] = parse_double(text.data() + first, last, numbers.emplace_back());
    if (error != std::errc() || after != last) fail();
    first = end + 1;
  }
  if (numbers.size() != 3 || std::abs(numbers[0]) > 180.0 || std::abs(numbers[1]) > 90.0 ||
      !(std::abs(numbers[2]) <= 1e7))
    fail();
  return {numbers[0], numbers[1], numbers[2]};
}

void check(const Options& options, const hlod::Hlod& hlod) {
  if (hlod.data().grouping != hlod::Grouping::nested)
    throw Error({options.file, "", "has shifted groups, whose nodes have several parents, and tiles form a tree",
                 "build it with --grouping nested --borders free"});
  tiles::check_tileset_output(options.folder, options.tileset.replace);
}

tiles::TilesetCounts write(const Options& options, const hlod::Hlod& hlod) {
  Progress progress(options.progress);
  tiles::TilesetOptions tileset = options.tileset;
  tileset.image_folder = options.images;
  if (options.images.empty()) tileset.image_folder = folder_of(options.file);
  if (!options.origin.empty()) tileset.origin = parse_origin(options.origin);
  const std::string what = "writing " + options.folder;
  tileset.progress = [&](double done) { progress.show(what, done, hlod.data().input_triangle_count); };
  const WriteMonitor monitor([](std::uint64_t) { note_interrupts(); });
  return write_tileset(options.folder, hlod, tileset, options.tiles_per_file);
}

void run(const Options& options) {
  handle_interrupts("hlod export");
  if (!options.origin.empty()) static_cast<void>(parse_origin(options.origin));
  Stopwatch stopwatch;
  const OhlodFile file = read_ohlod(options.file);
  check(options, file.hlod);
  const tiles::TilesetCounts counts = write(options, file.hlod);
  const double milliseconds = stopwatch.milliseconds();

  const auto triangles = static_cast<double>(file.hlod.data().input_triangle_count);
  const Json result = {{"file", options.file},
                       {"folder", options.folder},
                       {"up", options.tileset.up.value_or(file.hlod.data().up) == UpAxis::y ? "y" : "z"},
                       {"tiles", counts.tiles},
                       {"tileset_files", counts.tileset_files},
                       {"triangles", counts.triangles},
                       {"skirt_triangles", counts.skirt_triangles},
                       {"content_bytes", counts.content_bytes},
                       {"bytes", counts.bytes},
                       {"bytes_per_triangle", static_cast<double>(counts.bytes) / triangles},
                       {"images_left_out", counts.images_left_out},
                       {"write_ms", milliseconds},
                       {"peak_bytes", peak_bytes()}};
  for (const std::string& image : counts.images_left_out)
    print_note(image + ": no image that glTF has, or not there; left out (--images names the folder that files are " +
               "relative to)");
  print_result(result, file.report.left_out, options.json);
}

}  // namespace

void add_hlod_export(CLI::App& hlod) {
  CLI::App& command = *hlod.add_subcommand("export", "Write an .ohlod file of nested groups as 3D Tiles");
  const auto options = std::make_shared<Options>();
  tiles::TilesetOptions& tileset = options->tileset;
  add_file(command, "FILE", options->file, "An .ohlod file, built with --grouping nested --borders free")->required();
  add_file(command, "-o,--output", options->folder, "Folder to write: new, empty, or with --replace that of a tileset")
      ->required()
      ->type_name("FOLDER");
  add_choice(command, "--compress", tileset.compression,
             {{"none", tiles::Compression::none}, {"meshopt", tiles::Compression::meshopt}},
             "meshopt: EXT_meshopt_compression, which CesiumJS and three.js read");
  command
      .add_option_function<int>(
          "--quantise",
          [&tileset](int bits) {
            if (bits > 0 && bits < min_bits)
              throw CLI::ValidationError("--quantise", std::to_string(bits) + " is not 0 or in [8, 16]");
            tileset.quantise_bits = bits;
          },
          "Bits of a coordinate within its tile, 8 to 16, and 8 of normals; 0: floats [14 with meshopt, else 0]")
      ->transform(in_range(WholeRange{0, max_bits}))
      ->type_name("N");
  command.add_flag("--skirts", tileset.skirts,
                   "Hang strips from the borders of tiles, which cover gaps between levels");
  add_choice(command, "--up", tileset.up, {{"z", std::optional(UpAxis::z)}, {"y", std::optional(UpAxis::y)}},
             "The axis of the input that points up [y when all of the input was glTF, else z]");
  command
      .add_option("--origin", options->origin, "Where the input's origin is on Earth (WGS84): degrees, degrees, metres")
      ->transform(not_empty())
      ->type_name("LON,LAT,H");
  add_number(command, "--tiles-per-file", options->tiles_per_file, WholeRange{1, max_tiles_per_file},
             "The most tiles in a .json file; more go on in others")
      ->capture_default_str();
  add_file(command, "--images", options->images,
           "Where image files are: the folder of the scene or mesh [that of FILE, from which names lead to them]")
      ->type_name("FOLDER");
  command.add_flag("--replace", tileset.replace, "Replace the tileset that FOLDER holds");
  command.callback([options, &command] {
    read_global_options(command, {.json = &options->json, .progress = &options->progress});
    run(*options);
  });
}

}  // namespace occlod::tool
