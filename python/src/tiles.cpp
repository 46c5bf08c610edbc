// 3D Tiles.
#include "occlod/tiles.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <optional>
#include <tuple>

#include "bindings.h"
#include "text.h"

namespace occlod::python {

using namespace nb::literals;
using tiles::TilesetCounts;
using tiles::TilesetOptions;

void bind_tiles(nb::module_& m) {
  nb::class_<TilesetCounts>(m, "TilesetCounts", "What write_tiles() has written.")
      .def_ro("tiles", &TilesetCounts::tiles, "With a content.")
      .def_ro("tileset_files", &TilesetCounts::tileset_files, ".json.")
      .def_ro("triangles", &TilesetCounts::triangles, "Of all contents, without skirts.")
      .def_ro("skirt_triangles", &TilesetCounts::skirt_triangles, "Of all contents.")
      .def_ro("content_bytes", &TilesetCounts::content_bytes, "Of all contents.")
      .def_ro("bytes", &TilesetCounts::bytes, "Of all files.")
      .def_ro("images_left_out", &TilesetCounts::images_left_out,
              "Files that are not there, and images in a format that glTF lacks; materials are written without them.");
  m.def(
      "write_tileset",
      [](const std::filesystem::path& folder, const hlod::Hlod& hlod, bool meshopt, std::optional<int> quantise_bits,
         bool skirts, std::optional<UpAxis> up, const std::optional<std::tuple<double, double, double>>& origin,
         const std::filesystem::path& images, bool replace, const std::optional<nb::callable>& progress) {
        TilesetOptions options;
        options.compression = meshopt ? tiles::Compression::meshopt : tiles::Compression::none;
        options.quantise_bits = quantise_bits;
        options.skirts = skirts;
        options.up = up;
        if (origin) options.origin = {std::get<0>(*origin), std::get<1>(*origin), std::get<2>(*origin)};
        options.image_folder = images;
        options.replace = replace;
        options.progress = progress_of(progress ? nb::handle(*progress) : nb::handle(Py_None));
        const ReleasedGil release;
        return write_tileset(folder, hlod, options);
      },
      "folder"_a, "hlod"_a, nb::kw_only(), "meshopt"_a, "quantise_bits"_a.none(), "skirts"_a, "up"_a.none(),
      "origin"_a.none(), "images"_a, "replace"_a, "progress"_a.none(), "See write_tiles().");
  m.def("check_tileset_output", &tiles::check_tileset_output, "folder"_a, "replace"_a,
        "Raises what write_tiles() raises for this folder.");
}

}  // namespace occlod::python
