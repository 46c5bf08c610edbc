// Hidden names beside a file or folder, under which it is written before it is renamed.
#pragma once

#include <filesystem>

namespace occlod {

// Unique among the running processes and among the files of this one. `target`: with links followed.
[[nodiscard]] std::filesystem::path hidden_neighbour(const std::filesystem::path& target);

// Removes what processes that were killed while they wrote `target` have left beside it, when it is a minute old.
void remove_leftovers(const std::filesystem::path& target);

// Of a path without one: ".".
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& file);

}  // namespace occlod
