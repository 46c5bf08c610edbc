// What the subcommands of `occlod cells` share.
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
void add_cells_check(CLI::App& cells);
void add_cells_info(CLI::App& cells);
void add_cells_merge(CLI::App& cells);
void add_cells_pack(CLI::App& cells);
void add_cells_walk(CLI::App& cells);

// The objects of a scene, or of a file of one object, ready for cells.
struct CellScene {
  std::vector<LoadedObject> loaded;
  std::vector<RefineObject> objects;  // point into `loaded`
  std::vector<std::string> names;     // by object, for people
};
// Shows progress and notes on standard error. Throws Error.
[[nodiscard]] CellScene load_cell_scene(const SceneDescription& scene, const std::filesystem::path& file,
                                        bool use_cache);

// Of different hierarchies.
[[nodiscard]] std::size_t hierarchy_bytes(std::span<const RefineObject> objects);

// Numbers of the form "1,2.5,-3": so many, finite. Nothing for anything else.
[[nodiscard]] std::optional<std::vector<double>> numbers_in(const std::string& text, std::size_t count);

// What a file holds: options, cells, what they draw, bytes.
[[nodiscard]] Json to_json(const VlodFile& file);

}  // namespace occlod::tool
