// HLODs whose meshes come and go: options, and what is told of their stores.
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

// --cache, --load. Returns the former; nothing is set without it.
CLI::Option* add_cache_options(CLI::App& command, std::optional<hlod::CacheOptions>& options);
// With the mode as it is given on the command line.
[[nodiscard]] Json to_json(const hlod::CacheOptions& options);

// The sum over the stores of these objects, each counted once; nothing where there are none.
[[nodiscard]] std::optional<hlod::StoreStats> store_stats(std::span<const hlod::PlacedHlod> placed);
// What a frame has changed, and what is there after it.
[[nodiscard]] Json to_json(const hlod::StoreStats& after, const hlod::StoreStats& before);
// Notes what has failed since the last call on standard error, one line each.
void print_failures(std::span<const hlod::PlacedHlod> placed);

}  // namespace occlod::tool
