// A limit for builds of meshes larger than memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

namespace occlod {

// While one lives, arrays of some megabytes that the library makes lie in files without names in a folder, and a thread
// watches how much main memory the process has: whenever that comes near `bytes`, all pages of these files leave it.
// What is touched again comes back from the system's cache or from the disk. What is built never depends on it. Files
// go when their arrays do, and when the process ends, however it ends.
//
// Meant for build_hlod() from a TriangleSource: its arrays are read and written in order, or near where they were read
// last. Small arrays and whatever the program has beside stay in memory, so `bytes` has to leave room for them: an HLOD
// takes about half a byte for each triangle of its input that way. Linux only; one at a time in a process.
class MemoryLimit {
 public:
  // bytes >= 2^26, of all the process has. Throws Error for less, where the system does not tell how much a process
  // has, for a folder that takes no files, and where there is a limit already. While it lives, building throws Error
  // when the folder's disk is full.
  MemoryLimit(std::size_t bytes, const std::filesystem::path& folder);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

  // The most that all files together have had at a time.
  [[nodiscard]] std::size_t most_scratch_bytes() const noexcept;

 private:
  class Watch;
  std::unique_ptr<Watch> watch_;
};

}  // namespace occlod
