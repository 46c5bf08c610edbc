#include "core/platform.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

namespace occlod {
namespace {

[[noreturn]] void fail(int error_number) { throw std::system_error(error_number, std::generic_category()); }

// Throws std::system_error when it is no regular file.
std::size_t size_of_file(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) fail(errno);
  if (!S_ISREG(status.st_mode)) fail(S_ISDIR(status.st_mode) ? EISDIR : EINVAL);
  return static_cast<std::size_t>(status.st_size);
}

}  // namespace

void advise_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(MADV_HUGEPAGE)
  static_cast<void>(madvise(memory, bytes, MADV_HUGEPAGE));  // advice only: without huge pages nothing changes
#endif
}

void give_pages_back([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(MADV_DONTNEED)
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE)),
             begin = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t first = (begin + page - 1) / page * page, end = (begin + bytes) / page * page;
  if (first < end) static_cast<void>(madvise(reinterpret_cast<void*>(first), end - first, MADV_DONTNEED));
#endif
}

int process_id() noexcept { return getpid(); }

bool may_be_running(int process) noexcept { return kill(process, 0) == 0 || errno != ESRCH; }

int why_no_files_can_be_made(const char* folder) noexcept { return access(folder, W_OK | X_OK) == 0 ? 0 : errno; }

InputFile::InputFile(const char* path) : descriptor_(open(path, O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) fail(errno);
  try {
    size_ = size_of_file(descriptor_);
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

InputFile::~InputFile() { close(descriptor_); }

void InputFile::read(std::span<std::byte> bytes, std::uint64_t offset) const {
  while (!bytes.empty()) {
    const ssize_t got = pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail(got < 0 ? errno : EIO);
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
}

std::span<const std::byte> InputFile::map() const {
  void* const begin = mmap(nullptr, size_, PROT_READ, MAP_SHARED, descriptor_, 0);
  if (begin == MAP_FAILED) fail(errno);
  return {static_cast<const std::byte*>(begin), size_};
}

void unmap(std::span<const std::byte> bytes) noexcept { munmap(const_cast<std::byte*>(bytes.data()), bytes.size()); }

}  // namespace occlod
