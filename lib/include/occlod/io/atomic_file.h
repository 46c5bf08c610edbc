// A file that appears whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>

namespace occlod {

// Writes to a hidden file beside `path`; commit() flushes it, checks for errors and renames it over `path`. Without
// commit() the destructor removes it and `path` stays as it was. A symbolic link is followed; a folder, a device or a
// pipe is refused. Throws Error that names `path`.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] std::ostream& stream() noexcept { return stream_; }
  void write(std::span<const std::byte> bytes);
  void commit();

 private:
  std::filesystem::path path_;       // as given
  std::filesystem::path target_;     // with symbolic links followed
  std::filesystem::path temporary_;  // empty after commit()
  std::ofstream stream_;
};

}  // namespace occlod
