// Parses numbers with a unit: ratios, which may be in %, and lengths, which may be in mm, cm, m or %.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

namespace occlod::tool {

// A length in the mesh's unit, in metres, or relative to the diagonal of the mesh's bounding box.
struct Length {
  enum class Of { mesh, metre, diagonal } of = Of::mesh;
  double value = 0.0;
};

// Takes "10%" and "0.1"; returns nothing for other text and for what is not in [0, 1].
[[nodiscard]] std::optional<double> ratio_of(const std::string& text);
// Takes "0.5", "0.5mm", "0.5cm", "0.5m" and "0.1%"; returns nothing for other text and for what is below 0.
[[nodiscard]] std::optional<Length> length_of(const std::string& text);

// Returns the length in units of the mesh in `file`, whose box has this diagonal. Throws Error for metres of a file
// that is not glTF.
[[nodiscard]] double in_mesh_units(const Length& length, const std::string& file, double diagonal);

// Adds --ratio, above 0.
CLI::Option* add_ratio(CLI::App& command, std::optional<double>& ratio, const std::string& about);
// Adds --error, at least 0, or above it.
enum class Zero { taken, refused };
CLI::Option* add_error(CLI::App& command, std::optional<Length>& error, Zero zero, const std::string& about);

}  // namespace occlod::tool
