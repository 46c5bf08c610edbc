#include "hlod_cache.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <set>

#include "option_values.h"
#include "standard_streams.h"

namespace occlod::tool {
namespace {

std::set<hlod::NodeStore*> stores_of(std::span<const hlod::PlacedHlod> placed) {
  std::set<hlod::NodeStore*> stores;
  for (const hlod::PlacedHlod& object : placed)
    if (object.hlod->store() != nullptr) stores.insert(object.hlod->store());
  return stores;
}

}  // namespace

CLI::Option* add_cache_options(CLI::App& command, std::optional<hlod::CacheOptions>& options) {
  const auto chosen = std::make_shared<hlod::CacheOptions>();
  CLI::Option* const memory = command.add_option_function<std::uint64_t>(
      "--memory",
      [&options, chosen](std::uint64_t bytes) {
        chosen->budget_bytes = bytes;
        options = *chosen;
      },
      "Of .ohlod files: read meshes when they are needed, and keep no more than so many bytes of them in memory such "
      "as 256M");
  memory->transform(in_bytes("1"))->option_text("BYTES");
  command
      .add_option_function<std::string>(
          "--load",
          [&options, chosen](const std::string& text) {
            chosen->load = text == "blocking" ? hlod::LoadMode::blocking : hlod::LoadMode::async;
            if (options) *options = *chosen;
          },
          "How meshes are read: async: by a thread of its own, coarser ones are drawn until they are there; blocking: "
          "frames wait for them")
      ->transform(one_of({"async", "blocking"}))
      ->option_text("async|blocking [async]")
      ->needs(memory);
  return memory;
}

Json to_json(const hlod::CacheOptions& options) {
  return {{"budget_bytes", options.budget_bytes},
          {"load", options.load == hlod::LoadMode::async ? "async" : "blocking"}};
}

std::optional<hlod::StoreStats> store_stats(std::span<const hlod::PlacedHlod> placed) {
  std::optional<hlod::StoreStats> sum;
  for (const hlod::NodeStore* store : stores_of(placed)) {
    const hlod::StoreStats stats = store->stats();
    if (!sum) sum.emplace();
    sum->budget_bytes += stats.budget_bytes;
    sum->resident_nodes += stats.resident_nodes;
    sum->resident_bytes += stats.resident_bytes;
    sum->loading_bytes += stats.loading_bytes;
    sum->missing += stats.missing;
    sum->failed += stats.failed;
    sum->loads += stats.loads;
    sum->bytes_loaded += stats.bytes_loaded;
    sum->reads += stats.reads;
    sum->evictions += stats.evictions;
  }
  return sum;
}

Json to_json(const hlod::StoreStats& after, const hlod::StoreStats& before) {
  return {{"resident_nodes", after.resident_nodes},
          {"resident_bytes", after.resident_bytes},
          {"loading_bytes", after.loading_bytes},
          {"missing", after.missing},
          {"failed", after.failed},
          {"loads", after.loads - before.loads},
          {"bytes_loaded", after.bytes_loaded - before.bytes_loaded},
          {"reads", after.reads - before.reads},
          {"evictions", after.evictions - before.evictions}};
}

void print_failures(std::span<const hlod::PlacedHlod> placed) {
  for (hlod::NodeStore* store : stores_of(placed))
    for (const std::string& line : store->take_failures()) print_note(line);
}

}  // namespace occlod::tool
