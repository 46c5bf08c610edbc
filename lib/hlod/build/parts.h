// The files by which processes share the work of one level: a task has the groups that one of them simplifies, its
// result the nodes that come of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "hlod/build/finish_level.h"
#include "hlod/build/group_simplifier.h"

namespace occlod::hlod {

inline constexpr std::string_view task_extension = ".task", result_extension = ".nodes";

// Holds the bytes of a task file, and the checksum by which its result names it.
struct PartTask {
  std::vector<std::byte> bytes;
  std::uint64_t checksum = 0;
};

// Packs groups into a task. O(bytes).
[[nodiscard]] PartTask pack_task(const GroupRules& rules, std::span<const GroupInput> groups);

// Writes the file of a task, which appears whole or not at all. Throws Error.
void write_task(const std::filesystem::path& path, const PartTask& task);

// Returns the name of a task's result.
[[nodiscard]] std::filesystem::path result_of(std::filesystem::path task);

// Reads the result of a task that has so many groups into `nodes`. Returns false when it is not there, not whole, or
// that of another task or version. Throws Error when the system cannot read it. O(bytes).
[[nodiscard]] bool read_result(const std::filesystem::path& result, std::uint64_t task_checksum,
                               std::span<SimplifiedNode> nodes);

}  // namespace occlod::hlod
