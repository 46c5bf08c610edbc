// Compression of the sections of .olod files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace occlod::olod {

// The k-th bytes of all elements, for every k, one after the other: neighbouring elements resemble each other byte by
// byte. A rest that is no whole element stays at the end. Spans of the same size.
void separate(std::span<const std::byte> elements, std::size_t element_bytes, std::span<std::byte> planes);
// The reverse.
void join(std::span<const std::byte> planes, std::size_t element_bytes, std::span<std::byte> elements);

// zstd frames of up to packed_run raw bytes each, whose elements are separated.
[[nodiscard]] std::vector<std::byte> pack(std::span<const std::byte> raw, std::size_t element_bytes);

// The reverse; false when `packed` is damaged or does not hold exactly `raw.size()` bytes. Never writes outside `raw`.
[[nodiscard]] bool unpack(std::span<const std::byte> packed, std::size_t element_bytes, std::span<std::byte> raw);

// Whether a section can decompress to so many bytes: files hold nothing that compresses better, so one that claims more
// is refused before memory is allocated.
[[nodiscard]] constexpr bool is_plausible(std::uint64_t packed_bytes, std::uint64_t raw_bytes) {
  return raw_bytes / 64 <= packed_bytes;
}

}  // namespace occlod::olod
