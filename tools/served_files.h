// What a request asks for, as a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace occlod::tool {

// A part of a file: [first, first + size).
struct ByteRange {
  std::uint64_t first = 0;
  std::uint64_t size = 0;
};

// What is written with percent signs, without a query. Nothing for what no path is.
[[nodiscard]] std::optional<std::string> path_of_target(std::string_view target);

// A regular file in `folder`, once all links are followed; nothing else. `name`: relative, '/' between its parts.
[[nodiscard]] std::optional<std::filesystem::path> file_in(const std::filesystem::path& folder,
                                                           const std::string& name);

// "bytes=A-B", "bytes=A-", "bytes=-N" of a file of `size` bytes. Nothing for what asks for no byte that is there;
// the whole file for other units and several ranges, which a server may ignore (RFC 9110, 14.2).
[[nodiscard]] std::optional<ByteRange> range_of(std::string_view header, std::uint64_t size);

// By the extension.
[[nodiscard]] const char* mime_type(const std::filesystem::path& file);

}  // namespace occlod::tool
