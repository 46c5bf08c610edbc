// Adds options for HLODs with node stores, and reports on the stores.
#pragma once

#include <optional>
#include <span>

#include "json_output.h"
#include "occlod/device.h"
#include "occlod/node_store.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace occlod::tool {

// Adds --memory and --load, and returns the former. Without it `options` stays empty.
CLI::Option* add_cache_options(CLI::App& command, std::optional<hlod::CacheOptions>& options);
// Writes the mode as on the command line.
[[nodiscard]] Json to_json(const hlod::CacheOptions& options);

// Returns the sum over the stores of these objects, each counted once; nothing if there are none.
[[nodiscard]] std::optional<hlod::StoreStats> store_stats(std::span<const hlod::PlacedHlod> placed);
// Returns what a frame has changed, and the state after it.
[[nodiscard]] Json to_json(const hlod::StoreStats& after, const hlod::StoreStats& before);
// Prints what has failed since the last call on standard error, one line each.
void print_failures(std::span<const hlod::PlacedHlod> placed);

}  // namespace occlod::tool
