// Finds the file that a request asks for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace occlod::tool {

// Names a part of a file: [first, first + size).
struct ByteRange {
  std::uint64_t first = 0;
  std::uint64_t size = 0;
};

// Decodes percent signs and drops the query. Returns nothing if the result is no path.
[[nodiscard]] std::optional<std::string> path_of_target(std::string_view target);

// Returns a regular file that is in `folder` after following all links; otherwise nothing. `name` is relative, with '/'
// between its parts.
[[nodiscard]] std::optional<std::filesystem::path> file_in(const std::filesystem::path& folder,
                                                           const std::string& name);

// Parses "bytes=A-B", "bytes=A-" or "bytes=-N" for a file of `size` bytes. Returns nothing if no requested byte exists;
// the whole file for other units and several ranges, which a server may ignore (RFC 9110, 14.2).
[[nodiscard]] std::optional<ByteRange> range_of(std::string_view header, std::uint64_t size);

// Chooses the type by the extension.
[[nodiscard]] const char* mime_type(const std::filesystem::path& file);

}  // namespace occlod::tool
