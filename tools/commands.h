// The subcommands. Each adds itself to the command line and does its work when it is chosen, throwing Error when that
// fails.
#pragma once

namespace CLI {
class App;
}

namespace occlod::tool {

void add_build(CLI::App& app);
void add_cells(CLI::App& app);    // with subcommands of its own, as hlod
void add_compare(CLI::App& app);  // where OCCLOD_HAS_CGAL is defined, as repair
void add_cut(CLI::App& app);
void add_generate(CLI::App& app);
void add_hlod(CLI::App& app);
void add_info(CLI::App& app);
void add_render(CLI::App& app);
void add_repair(CLI::App& app);
void add_validate(CLI::App& app);

}  // namespace occlod::tool
