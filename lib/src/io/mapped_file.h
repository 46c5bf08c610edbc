// A file's bytes in memory without reading them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace occlod {

class MappedFile {
 public:
  // Throws Error when there is no such regular file, or it cannot be mapped.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  // Starts at a page, so at any alignment. Pages are loaded when they are first read.
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace occlod
