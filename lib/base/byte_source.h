// Bytes that are read in parts: those of a file, or what has arrived of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace occlod {

class InputFile;

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

// Returns the bytes of an open file.
[[nodiscard]] std::shared_ptr<const ByteSource> byte_source_of(std::shared_ptr<const InputFile> file);

}  // namespace occlod
