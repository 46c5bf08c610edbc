// Declares the subcommands. Each function adds one to the command line; the command works when it is chosen, and throws
// Error when it fails.
#pragma once

namespace CLI {
class App;
}

namespace occlod::tool {

void add_build(CLI::App& app);
void add_cells(CLI::App& app);    // has subcommands, like hlod
void add_compare(CLI::App& app);  // only where OCCLOD_HAS_CGAL is defined, like repair
void add_cut(CLI::App& app);
void add_simplify(CLI::App& app);
void add_generate(CLI::App& app);
void add_hlod(CLI::App& app);
void add_info(CLI::App& app);
void add_render(CLI::App& app);
void add_repair(CLI::App& app);
void add_serve(CLI::App& app);  // only where OCCLOD_HAS_SERVER is defined
void add_tiles(CLI::App& app);
void add_validate(CLI::App& app);

}  // namespace occlod::tool
