// MD5 (RFC 1321), by which the index of an archive finds files. It protects nothing.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace occlod::tiles {

// Returns the digest in the order in which it is written as hexadecimal digits. O(size).
[[nodiscard]] std::array<std::uint8_t, 16> md5(std::string_view text);

}  // namespace occlod::tiles
