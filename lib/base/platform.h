// All that the library asks of the operating system and the compiler beyond C++, but for OpenGL's drivers. platform.cpp
// is for POSIX: another system needs another one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace occlod {

// A hint: the cache line at `address` will soon be read or written.
inline void prefetch([[maybe_unused]] const void* address) noexcept {
#if defined(__GNUC__)
  __builtin_prefetch(address);
#endif
}

// A hint: this thread looks at the same place again and again.
inline void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

// Huge pages, where the system has them, may back these bytes.
void advise_huge_pages(void* memory, std::size_t bytes) noexcept;
// Whole pages among these bytes may lose their contents, and take no memory until they are used again.
void give_pages_back(void* memory, std::size_t bytes) noexcept;

// A file without a name in a folder, with room for all its bytes, in memory for reading and writing.
class ScratchFile {
 public:
  // Throws std::system_error with the system's reason, such as a full disk.
  ScratchFile(const char* folder, std::size_t bytes);
  ~ScratchFile();
  ScratchFile(ScratchFile&& other) noexcept;
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ScratchFile& operator=(ScratchFile&&) = delete;

  [[nodiscard]] std::span<std::byte> bytes() const noexcept { return mapped_; }
  // Its pages leave this process and stay in the file. Threads that touch them wait until all have left; then what they
  // touch comes back.
  void page_out() const noexcept;

 private:
  int descriptor_;
  std::span<std::byte> mapped_;
};

// Main memory that this process has now, bytes; 0 where the system does not tell.
struct ResidentMemory {
  std::size_t all = 0;
  std::size_t of_files = 0;  // that are mapped
};
[[nodiscard]] ResidentMemory resident_memory() noexcept;

[[nodiscard]] int process_id() noexcept;
// False only when there is surely no such process on this machine.
[[nodiscard]] bool may_be_running(int process) noexcept;

// 0, or the number of the error that keeps this process from making files in a folder.
[[nodiscard]] int why_no_files_can_be_made(const char* folder) noexcept;

// A regular file, open for reading. What fails throws std::system_error with the system's reason.
class InputFile {
 public:
  explicit InputFile(const char* path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  // The bytes of the file from `offset` on; fails when it has become shorter than that. For any thread.
  void read(std::span<std::byte> bytes, std::uint64_t offset = 0) const;
  // Likewise into several arrays in turn, in few calls of the system.
  void read(std::span<const std::span<std::byte>> parts, std::uint64_t offset) const;
  // The whole file in memory, of at least one byte, without reading it. Outlives this object; end it with unmap().
  [[nodiscard]] std::span<const std::byte> map() const;

 private:
  int descriptor_;
  std::size_t size_ = 0;
};

void unmap(std::span<const std::byte> bytes) noexcept;

// A regular file, made where there is none, that one object at a time on this machine reads and appends to. What fails
// throws std::system_error with the system's reason: std::errc::resource_unavailable_try_again while another has it.
class JournalFile {
 public:
  explicit JournalFile(const char* path);
  ~JournalFile();
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  // The bytes from `offset` on; fails when the file ends before.
  void read(std::span<std::byte> bytes, std::uint64_t offset) const;
  // At the end, in the system's hands when this returns: they outlive the process. What fails leaves a part of them.
  void append(std::span<const std::byte> bytes);
  // To its first `size` bytes, at most size().
  void cut(std::uint64_t size);

 private:
  int descriptor_;
  std::uint64_t size_ = 0;
};

// Two names of a file system swapped.

// Gives each of two files or folders the other's name, at once. False where the system or the file system cannot.
[[nodiscard]] bool exchange_names(const char* a, const char* b) noexcept;

}  // namespace occlod
