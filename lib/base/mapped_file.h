// A file's bytes in memory without reading them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

#include "base/large_vector.h"
#include "base/platform.h"

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

// The same bytes in memory, at any alignment up to 64. Throws Error likewise, and when they cannot all be read.
[[nodiscard]] LargeVector<std::byte> read_whole(const std::filesystem::path& path);

// A file to be read in parts, whatever becomes of its name. Throws Error when there is no such regular file.
[[nodiscard]] std::shared_ptr<const InputFile> open_file(const std::filesystem::path& path);

}  // namespace occlod
