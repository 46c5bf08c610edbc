#include "tileset_output.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <system_error>
#include <vector>

#include "base/text.h"
#include "interrupt.h"
#include "occlod/node_store.h"
#include "option_values.h"
#include "standard_streams.h"

namespace occlod::tool {
namespace {

constexpr int min_bits = 8, max_bits = 16;
constexpr std::uint64_t max_tiles_per_file = 1'000'000;

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

}  // namespace

void add_tileset_output(CLI::App& command, TilesetOutput& output) {
  tiles::TilesetOptions& tileset = output.tileset;
  add_file(command, "-o,--output", output.path,
           "Folder to write: new, empty, or with --replace that of a tileset; or an archive, whose name ends in .3tz")
      ->required()
      ->type_name("OUTPUT");
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
      .add_option("--origin", output.origin, "Where the input's origin is on Earth (WGS84): degrees, degrees, metres")
      ->transform(not_empty())
      ->type_name("LON,LAT,H");
  add_file(command, "--images", output.images,
           "Where image files are: the folder of the scene or mesh [that of the input, from which names lead to them]")
      ->type_name("FOLDER");
  add_choice(command, "--texture-format", tileset.texture_format,
             {{"png", std::optional(tiles::TextureFormat::png)}, {"jpeg", std::optional(tiles::TextureFormat::jpeg)}},
             "Of the images that tiles have of their own [as the input's]");
  command.add_flag("--replace", tileset.replace, "Replace the tileset that OUTPUT is");
  add_number(command, "--tiles-per-file", output.tiles_per_file, WholeRange{1, max_tiles_per_file},
             "The most tiles in a .json file; more go on in others")
      ->capture_default_str();
}

void check(const TilesetOutput& output) {
  if (!output.origin.empty()) static_cast<void>(parse_origin(output.origin));
  tiles::check_tileset_options(output.tileset);
  tiles::check_tileset_output(output.path, output.tileset.replace);
}

Json write_tileset(const TilesetOutput& output, const hlod::Hlod& hlod, const std::filesystem::path& input_folder,
                   Progress& progress) {
  tiles::TilesetOptions tileset = output.tileset;
  tileset.image_folder = output.images.empty() ? input_folder : std::filesystem::path(output.images);
  if (!output.origin.empty()) tileset.origin = parse_origin(output.origin);
  const std::string what = "writing " + output.path;
  tileset.progress = [&](double done) { progress.show(what, done, hlod.data().input_triangle_count); };
  const WriteMonitor monitor([](std::uint64_t) { note_interrupts(); });
  const tiles::TilesetCounts counts = write_tileset(output.path, hlod, tileset, output.tiles_per_file);
  progress.clear();
  for (const std::string& image : counts.images_left_out)
    print_note(image + ": no image that glTF has, or not there; left out (--images names the folder that files are " +
               "relative to)");
  if (const auto& shared = counts.images_shared; !shared.empty())
    print_note(shared[0].name + " stays one file for all tiles: " + shared[0].reason +
               (shared.size() > 1 ? fmt::format("; and {} more images do", shared.size() - 1) : ""));
  Json shared = Json::array();
  for (const tiles::SharedImage& image : counts.images_shared) shared.push_back(image.name);
  const auto triangles = static_cast<double>(hlod.data().input_triangle_count);
  return {{tiles::is_archive(output.path) ? "archive" : "folder", output.path},
          {"up", tileset.up.value_or(hlod.data().up) == UpAxis::y ? "y" : "z"},
          {"features", hlod.data().features.names.size()},
          {"tiles", counts.tiles},
          {"tileset_files", counts.tileset_files},
          {"triangles", counts.triangles},
          {"skirt_triangles", counts.skirt_triangles},
          {"content_bytes", counts.content_bytes},
          {"bytes", counts.bytes},
          {"bytes_per_triangle", static_cast<double>(counts.bytes) / triangles},
          {"images_left_out", counts.images_left_out},
          {"images_shared", shared},
          {"texels", counts.texels},
          {"source_texels", counts.source_texels},
          {"texture_bytes", counts.texture_bytes},
          {"charts", counts.charts}};
}

}  // namespace occlod::tool
