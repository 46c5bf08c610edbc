// Compression of the sections of .olod files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace occlod::olod {

// zstd frames of up to packed_run raw bytes each. Within a frame the k-th bytes of all elements are stored together,
// because neighbouring elements resemble each other byte by byte.
[[nodiscard]] std::vector<std::byte> pack(std::span<const std::byte> raw, std::size_t element_bytes);

// The reverse; false when `packed` is damaged or does not hold exactly `raw.size()` bytes. Never writes outside `raw`.
[[nodiscard]] bool unpack(std::span<const std::byte> packed, std::size_t element_bytes, std::span<std::byte> raw);

// Whether a section can decompress to so many bytes: no hierarchy compresses better, so a file that claims more is
// refused before memory is allocated.
[[nodiscard]] constexpr bool is_plausible(std::uint64_t packed_bytes, std::uint64_t raw_bytes) {
  return raw_bytes / 64 <= packed_bytes;
}

}  // namespace occlod::olod
