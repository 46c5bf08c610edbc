// Writes ZIP files whose entries are stored, not compressed, by APPNOTE 6.3.9 within ISO/IEC 21320-1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <utility>

#include "base/memory.h"

namespace occlod::tiles {

// Passes the file on in consecutive pieces. Headers have the sizes and the checksum of their entries, which readers
// need who find entries without the directory at the end, and the date 1980-01-01 for all. The end has the 64-bit
// records where the file has more than 4 GB or 65,534 entries, and only there. Keeps 46 bytes and the name of each
// entry in memory.
class ZipWriter {
 public:
  using Write = std::function<void(std::span<const std::byte>)>;

  explicit ZipWriter(Write write) : write_(std::move(write)) {}

  // What an entry may hold, and its name, in bytes.
  static constexpr std::uint64_t max_bytes = 0xfffffffe;
  static constexpr std::size_t max_name = 0xffff;

  // Adds an entry; `name` is ASCII, relative, new, with '/' between its parts. Returns the offset of its local header.
  std::uint64_t add(std::string_view name, std::span<const std::byte> bytes);
  // Writes what follows the last entry.
  void finish();
  // Returns the number of bytes written so far.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

 private:
  void write(std::span<const std::byte> bytes);

  Write write_;
  std::uint64_t size_ = 0;
  std::uint64_t entries_ = 0;
  LargeVector<std::byte> directory_;
};

}  // namespace occlod::tiles
