// Bytes that are read in parts: those of a file, or what has arrived of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace occlod {

class ByteSource {
 public:
  ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;
  virtual ~ByteSource() = default;

  // Returns the number of all bytes.
  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
  // Reads consecutive bytes from `offset` on into several arrays, one after the other. Throws std::system_error when
  // they are not all there.
  virtual void read(std::span<const std::span<std::byte>> parts, std::uint64_t offset) const = 0;
};

}  // namespace occlod
