// Declares what the subcommands of `occlod cells` share.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "json_output.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"
#include "occlod/vlod_file.h"

namespace CLI {
class App;
}

namespace occlod::tool {

void add_cells_build(CLI::App& cells);
void add_cells_info(CLI::App& cells);
void add_cells_merge(CLI::App& cells);
void add_cells_pack(CLI::App& cells);
void add_cells_validate(CLI::App& cells);
void add_cells_walk(CLI::App& cells);

// Holds the objects of a scene, or of a file of one object, ready to build cells of.
struct CellScene {
  std::vector<LoadedObject> loaded;
  std::vector<RefineObject> objects;  // point into `loaded`
  std::vector<std::string> names;     // per object, for people
};
// Reads the scene or file. Shows progress and notes on standard error. Throws Error.
[[nodiscard]] CellScene load_cell_scene(const SceneDescription& scene, const std::filesystem::path& file,
                                        bool use_cache);

// Counts each hierarchy once.
[[nodiscard]] std::size_t hierarchy_bytes(std::span<const RefineObject> objects);

// Parses `count` finite numbers of the form "1,2.5,-3". Returns nothing for other text.
[[nodiscard]] std::optional<std::vector<double>> numbers_in(const std::string& text, std::size_t count);

// Returns what a file holds: options, cells, what they draw, bytes.
[[nodiscard]] Json to_json(const VlodFile& file);

}  // namespace occlod::tool
