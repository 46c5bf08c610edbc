// Everything that the library asks of the operating system and the compiler beyond C++, except OpenGL drivers.
// platform.cpp implements it for POSIX; another system needs its own implementation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace occlod {

// Hints that the cache line at `address` will soon be read or written.
inline void prefetch([[maybe_unused]] const void* address) noexcept {
#if defined(__GNUC__)
  __builtin_prefetch(address);
  // GCC takes functions that do nothing but prefetch for functions without effects, and drops calls of them.
  asm volatile("");
#endif
}

// Hints that this thread is in a spin loop.
inline void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

// Allows the system to back these bytes with huge pages.
void advise_huge_pages(void* memory, std::size_t bytes) noexcept;
// Frees the whole pages among these bytes: they take no memory until they are used again. Those of a mapped file come
// back from it, others lose their contents.
void give_pages_back(void* memory, std::size_t bytes) noexcept;

// A file without a name in a folder, mapped for reading and writing, with disk space reserved for all its bytes.
class ScratchFile {
 public:
  // Throws std::system_error with the system's reason, for instance a full disk.
  ScratchFile(const char* folder, std::size_t bytes);
  ~ScratchFile();
  ScratchFile(ScratchFile&& other) noexcept;
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ScratchFile& operator=(ScratchFile&&) = delete;

  [[nodiscard]] std::span<std::byte> bytes() const noexcept { return mapped_; }
  // Drops the file's pages from this process; their contents stay in the file. Threads that touch them meanwhile wait
  // until all pages have left; after that, touched pages come back.
  void page_out() const noexcept;

 private:
  int descriptor_;
  std::span<std::byte> mapped_;
};

// The main memory that this process occupies now, in bytes; 0 where the system does not tell.
struct ResidentMemory {
  std::size_t all = 0;
  std::size_t of_files = 0;  // of mapped files
};
[[nodiscard]] ResidentMemory resident_memory() noexcept;

[[nodiscard]] int process_id() noexcept;
// Grows with every fork() in the child, which has none of the threads that began before.
[[nodiscard]] unsigned fork_count() noexcept;
// Returns false only when there is surely no such process on this machine.
[[nodiscard]] bool may_be_running(int process) noexcept;

// Returns 0, or the error number that keeps this process from making files in a folder.
[[nodiscard]] int why_no_files_can_be_made(const char* folder) noexcept;

// True when a file system is mounted at this folder, which then can neither be renamed nor removed.
[[nodiscard]] bool is_mount_point(const char* folder) noexcept;

// A regular file, open for reading. Failures throw std::system_error with the system's reason.
class InputFile {
 public:
  explicit InputFile(const char* path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  // Reads from `offset` until `bytes` is full; fails when the file ends earlier. Any thread may call it.
  void read(std::span<std::byte> bytes, std::uint64_t offset = 0) const;
  // Reads consecutive bytes from `offset` on into several arrays, one after the other, in few system calls. Any thread
  // may call it.
  void read(std::span<const std::span<std::byte>> parts, std::uint64_t offset) const;
  // Maps the whole file, which has at least one byte, without reading it. The mapping outlives this object; end it with
  // unmap().
  [[nodiscard]] std::span<const std::byte> map() const;

 private:
  int descriptor_;
  std::size_t size_ = 0;
};

void unmap(std::span<const std::byte> bytes) noexcept;

// A regular file, created if missing, that at most one object on this machine opens at a time, to read and to append.
// Failures throw std::system_error with the system's reason: std::errc::resource_unavailable_try_again while another
// object has the file open.
class JournalFile {
 public:
  explicit JournalFile(const char* path);
  ~JournalFile();
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  // Reads from `offset` until `bytes` is full; fails when the file ends earlier.
  void read(std::span<std::byte> bytes, std::uint64_t offset) const;
  // Appends at the end. When it returns, the system has the bytes, so they outlive the process; when it fails, a part
  // of them may be in the file.
  void append(std::span<const std::byte> bytes);
  // Truncates the file to its first `size` bytes; `size` is at most size().
  void cut(std::uint64_t size);

 private:
  int descriptor_;
  std::uint64_t size_ = 0;
};

// Swaps the names of two files or folders atomically. Returns false where the system or the file system cannot.
[[nodiscard]] bool exchange_names(const char* a, const char* b) noexcept;

}  // namespace occlod
