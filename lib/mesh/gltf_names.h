// Finds what a glTF file holds by name, in its JSON text, since parsers know only some of it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace occlod {

// Counts, for each extension, the objects that have it. `text` is valid JSON, not nested too deeply. O(size).
[[nodiscard]] std::map<std::string, std::uint64_t> count_extensions(std::string_view text);

// Counts the objects with a key. `text` is valid JSON.
[[nodiscard]] std::uint64_t count_key(std::string_view text, std::string_view key);

}  // namespace occlod
