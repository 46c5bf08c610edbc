// Adds the options that may stand before or after the name of a command: --json, --progress, --threads and --no-cache.
#pragma once

#include "progress.h"

namespace CLI {
class App;
}

namespace occlod::tool {

// Points to where a command stores each option; null if it does not use it.
struct GlobalOptions {
  bool* json = nullptr;
  ShowProgress* progress = nullptr;
  int* threads = nullptr;  // 0: one per core
  bool* use_cache = nullptr;
};

// Must be called before commands are added.
void add_global_options(CLI::App& app);

// Sets the options that were given, and leaves the others unchanged. Call it in the callback of a command. Throws
// CLI::ValidationError for an option that the command does not use.
void read_global_options(const CLI::App& command, const GlobalOptions& options);

}  // namespace occlod::tool
