// Declares what the subcommands of `occlod hlod` share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "json_output.h"
#include "map_system.h"
#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"
#include "occlod/node_store.h"
#include "progress.h"

namespace CLI {
class App;
}

namespace occlod::tool {

void add_hlod_build(CLI::App& hlod);
void add_hlod_info(CLI::App& hlod);
void add_hlod_render(CLI::App& hlod);
void add_hlod_validate(CLI::App& hlod);

// Reads all files, a mesh as it is, several meshes or scenes, into one mesh in world space.
[[nodiscard]] CleanMesh read_hlod_input(const std::vector<std::string>& files, Progress& progress);

// Reads the files piece by piece, for meshes larger than memory. `progress` must outlive the source.
[[nodiscard]] hlod::TriangleSource stream_hlod_input(const std::vector<std::string>& files, Progress& progress);

// Reads an .ohlod file whose groups are nested, as tilesets need. Throws Error for another.
[[nodiscard]] OhlodFile read_nested_ohlod(const std::string& file);

// The least that a build can keep to, for add_memory().
inline constexpr const char* min_build_memory = "64M";

void add_node_triangles(CLI::App& command, std::uint32_t& node_triangles);

struct BuiltHlod {
  hlod::Hlod hlod;
  MeshReport report;
  double read_ms = 0.0;         // time for reading, where it comes first
  std::size_t nodes_found = 0;  // in the journal
};

// Where meshes are brought before anything is built of them.
struct OnEarth {
  MapSystem* system = nullptr;    // of their coordinates; null: they stay
  std::optional<UpAxis> up = {};  // overrules their own
};

// Builds from all files, read piece by piece if `streams`, as a MemoryLimit needs.
[[nodiscard]] BuiltHlod build_from_files(const std::vector<std::string>& files, bool streams,
                                         const hlod::HlodBuildOptions& options, Progress& progress,
                                         const OnEarth& on_earth = {});

// Returns nodes, levels, roots, patches, triangles, stored_triangles, grouping, borders, node_triangles, within and
// bytes; lattice_step if positions were quantised; and with refinement within nodes splits and within_bytes, which is
// part of bytes.
[[nodiscard]] Json counts_of(const hlod::Hlod& hlod);
// Returns the size of its file.
[[nodiscard]] Json file_size_of(const std::string& file, const hlod::Hlod& hlod);

// Returns, for each level from the input up, nodes, triangles, vertices, the average number of parents and children of
// a node, and errors.
[[nodiscard]] Json levels_of(const hlod::Hlod& hlod);
// Prints them as a table for people.
void print_levels(const Json& levels);

}  // namespace occlod::tool
