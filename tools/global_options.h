// Options of the program, which may stand before or after the name of a command: --json, --progress, --threads and
// --no-cache.
#pragma once

#include "progress.h"

namespace CLI {
class App;
}

namespace occlod::tool {

// Where a command keeps what it has a use for; null: it has none.
struct GlobalOptions {
  bool* json = nullptr;
  ShowProgress* progress = nullptr;
  int* threads = nullptr;  // 0 = one per core
  bool* use_cache = nullptr;
};

// Before the commands are added.
void add_global_options(CLI::App& app);

// For the callback of a command: takes over what was given and leaves the rest as it is. Throws CLI::ValidationError
// when something was given that the command has no use for.
void read_global_options(const CLI::App& command, const GlobalOptions& options);

}  // namespace occlod::tool
