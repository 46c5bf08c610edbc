// 3D Tiles.
#include "occlod/tiles.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "bindings.h"
#include "text.h"

namespace occlod::python {

using namespace nb::literals;
using tiles::TilesetCounts;
using tiles::TilesetOptions;

namespace {

tiles::TextureFormat texture_format_of(const std::string& name) {
  if (name != "png" && name != "jpeg")
    throw Error({"write_tiles", "option texture_format", "is \"" + name + "\"", "give png, jpeg or None"});
  return name == "png" ? tiles::TextureFormat::png : tiles::TextureFormat::jpeg;
}

}  // namespace

void bind_tiles(nb::module_& m) {
  nb::class_<TilesetCounts>(m, "TilesetCounts", "What write_tiles() has written.")
      .def_ro("tiles", &TilesetCounts::tiles, "With a content.")
      .def_ro("tileset_files", &TilesetCounts::tileset_files, ".json.")
      .def_ro("triangles", &TilesetCounts::triangles, "Of all contents, without skirts.")
      .def_ro("skirt_triangles", &TilesetCounts::skirt_triangles, "Of all contents.")
      .def_ro("content_bytes", &TilesetCounts::content_bytes, "Of all contents.")
      .def_ro("bytes", &TilesetCounts::bytes, "Of all files, or of the archive.")
      .def_ro("images_left_out", &TilesetCounts::images_left_out,
              "Files that are not there, and images in a format that glTF lacks; materials are written without them.")
      .def_ro("texels", &TilesetCounts::texels, "Of the images that tiles have of their own.")
      .def_ro("source_texels", &TilesetCounts::source_texels, "Of the images that are divided among them.")
      .def_ro("texture_bytes", &TilesetCounts::texture_bytes, "Of the images that tiles have of their own, encoded.")
      .def_ro("charts", &TilesetCounts::charts, "Connected parts of the images of all tiles.")
      .def_prop_ro(
          "images_shared",
          [](const TilesetCounts& counts) {
            std::vector<std::tuple<std::string, std::string>> shared;
            for (const tiles::SharedImage& image : counts.images_shared) shared.emplace_back(image.name, image.reason);
            return shared;
          },
          "Images that stay one file for all tiles: the name of each, and why.");
  m.def(
      "write_tileset",
      [](const std::filesystem::path& folder, const hlod::Hlod& hlod, bool meshopt, std::optional<int> quantise_bits,
         bool skirts, std::optional<UpAxis> up, const std::optional<std::tuple<double, double, double>>& origin,
         const std::filesystem::path& images, const std::optional<std::string>& texture_format, int threads,
         bool replace, const std::optional<nb::callable>& progress) {
        TilesetOptions options;
        options.compression = meshopt ? tiles::Compression::meshopt : tiles::Compression::none;
        options.quantise_bits = quantise_bits;
        options.skirts = skirts;
        options.up = up;
        if (origin) options.origin = {std::get<0>(*origin), std::get<1>(*origin), std::get<2>(*origin)};
        options.image_folder = images;
        if (texture_format) options.texture_format = texture_format_of(*texture_format);
        options.threads = threads;
        options.replace = replace;
        options.progress = progress_of(progress ? nb::handle(*progress) : nb::handle(Py_None));
        const ReleasedGil release;
        return write_tileset(folder, hlod, options);
      },
      "folder"_a, "hlod"_a, nb::kw_only(), "meshopt"_a, "quantise_bits"_a.none(), "skirts"_a, "up"_a.none(),
      "origin"_a.none(), "images"_a, "texture_format"_a.none(), "threads"_a, "replace"_a, "progress"_a.none(),
      "See write_tiles().");
  m.def("check_tileset_output", &tiles::check_tileset_output, "folder"_a, "replace"_a,
        "Raises what write_tiles() raises for this folder.");
}

}  // namespace occlod::python
