// What the subcommands of `occlod hlod` share.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "json_output.h"
#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"
#include "progress.h"

namespace CLI {
class App;
}

namespace occlod::tool {

void add_hlod_build(CLI::App& hlod);
void add_hlod_export(CLI::App& hlod);
void add_hlod_info(CLI::App& hlod);
void add_hlod_render(CLI::App& hlod);
void add_hlod_serve(CLI::App& hlod);  // where OCCLOD_HAS_SERVER is defined
void add_hlod_validate(CLI::App& hlod);

// One mesh of all that these files hold: a mesh as it is, several, or scenes, together in world space.
[[nodiscard]] CleanMesh read_hlod_input(const std::vector<std::string>& files, Progress& progress);

// The same piece by piece, for meshes larger than memory. `progress` outlives it.
[[nodiscard]] hlod::TriangleSource stream_hlod_input(const std::vector<std::string>& files, Progress& progress);

// nodes, levels, roots, patches, triangles, stored_triangles, grouping, borders, node_triangles, within, bytes;
// lattice_step if positions were quantised; with refinement within nodes splits and within_bytes, which are part of
// bytes.
[[nodiscard]] Json counts_of(const hlod::Hlod& hlod);
// Of its file.
[[nodiscard]] Json file_size_of(const std::string& file, const hlod::Hlod& hlod);

// For each level from the input up: nodes, triangles, vertices, what a node has of parents and children on average, and
// its errors.
[[nodiscard]] Json levels_of(const hlod::Hlod& hlod);
// As a table, for people.
void print_levels(const Json& levels);

}  // namespace occlod::tool
