#include "base/platform.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

namespace occlod {
namespace {

[[noreturn]] void fail(int error_number) { throw std::system_error(error_number, std::generic_category()); }

// Throws std::system_error when it is not a regular file.
std::size_t size_of_file(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) fail(errno);
  if (!S_ISREG(status.st_mode)) fail(S_ISDIR(status.st_mode) ? EISDIR : EINVAL);
  if (!std::in_range<std::size_t>(status.st_size)) fail(EFBIG);
  return static_cast<std::size_t>(status.st_size);
}

// Reads from `offset` until `bytes` is full. Throws std::system_error, also when the file ends earlier.
void read_at(int descriptor, std::span<std::byte> bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t got = pread(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail(got < 0 ? errno : EIO);
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
}

// Returns a descriptor, or a negative number with errno set. Where the file system cannot make files without a name,
// the file has one for a moment.
int open_without_name(const char* folder) {
#if defined(O_TMPFILE)
  if (const int descriptor = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR); descriptor >= 0)
    return descriptor;
#endif
  std::string name = std::string(folder) + "/occlod_XXXXXX";
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor >= 0) unlink(name.c_str());
  return descriptor;
}

}  // namespace

void advise_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(MADV_HUGEPAGE)
  static_cast<void>(madvise(memory, bytes, MADV_HUGEPAGE));  // only advice: without huge pages nothing changes
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

ScratchFile::ScratchFile(const char* folder, std::size_t bytes) {
  descriptor_ = open_without_name(folder);
  if (descriptor_ < 0) fail(errno);
  int problem = posix_fallocate(descriptor_, 0, static_cast<off_t>(bytes));
  void* begin = nullptr;
  if (problem == 0) {
    begin = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0);
    if (begin == MAP_FAILED) problem = errno;
  }
  if (problem != 0) {
    close(descriptor_);
    fail(problem);
  }
  mapped_ = {static_cast<std::byte*>(begin), bytes};
}

ScratchFile::ScratchFile(ScratchFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), mapped_(std::exchange(other.mapped_, {})) {}

ScratchFile::~ScratchFile() {
  if (descriptor_ < 0) return;
  munmap(mapped_.data(), mapped_.size());
  close(descriptor_);
}

// Maps the file again at the same place: with madvise() other threads could bring pages back while the rest leaves.
void ScratchFile::page_out() const noexcept {
  static_cast<void>(
      mmap(mapped_.data(), mapped_.size(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, descriptor_, 0));
}

ResidentMemory resident_memory() noexcept {
#if defined(__linux__)
  const int descriptor = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return {};
  std::array<char, 128> text{};
  const ssize_t length = read(descriptor, text.data(), text.size() - 1);
  close(descriptor);
  unsigned long all = 0, of_files = 0;  // pages
  if (length <= 0 || std::sscanf(text.data(), "%*u %lu %lu", &all, &of_files) != 2) return {};
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return {all * page, of_files * page};
#else
  return {};
#endif
}

int process_id() noexcept { return getpid(); }

unsigned fork_count() noexcept {
  static std::atomic<unsigned> count = 0;
  [[maybe_unused]] static const int registered = pthread_atfork(nullptr, nullptr, [] { ++count; });
  return count;
}

bool may_be_running(int process) noexcept { return kill(process, 0) == 0 || errno != ESRCH; }

int why_no_files_can_be_made(const char* folder) noexcept { return access(folder, W_OK | X_OK) == 0 ? 0 : errno; }

bool is_mount_point(const char* folder) noexcept {
#ifdef STATX_ATTR_MOUNT_ROOT  // Linux
  struct statx found {};
  if (statx(AT_FDCWD, folder, 0, 0, &found) == 0 && (found.stx_attributes_mask & STATX_ATTR_MOUNT_ROOT) != 0)
    return (found.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
#endif
  struct stat inside {
  }, above{};
  return stat(folder, &inside) == 0 && stat((std::string(folder) + "/..").c_str(), &above) == 0 &&
         inside.st_dev != above.st_dev;
}

InputFile::InputFile(const char* path)
    :  // A pipe would wait for somebody to write into it.
      descriptor_(open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  if (descriptor_ < 0) fail(errno);
  try {
    size_ = size_of_file(descriptor_);
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

InputFile::~InputFile() { close(descriptor_); }

void InputFile::read(std::span<std::byte> bytes, std::uint64_t offset) const { read_at(descriptor_, bytes, offset); }

void InputFile::read(std::span<const std::span<std::byte>> parts, std::uint64_t offset) const {
  constexpr std::size_t max_parts = 64;  // in one call; every system allows 16, Linux 1,024
  std::array<iovec, max_parts> vectors{};
  while (true) {
    while (!parts.empty() && parts.front().empty()) parts = parts.subspan(1);
    if (parts.empty()) return;
    const std::size_t count = std::min(parts.size(), max_parts);
    for (std::size_t i = 0; i < count; ++i) vectors[i] = {parts[i].data(), parts[i].size()};
    ssize_t got = preadv(descriptor_, vectors.data(), static_cast<int>(count), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail(got < 0 ? errno : EIO);
    offset += static_cast<std::uint64_t>(got);
    for (; !parts.empty() && static_cast<std::size_t>(got) >= parts.front().size(); parts = parts.subspan(1))
      got -= static_cast<ssize_t>(parts.front().size());
    if (got == 0) continue;
    // The call may have filled an array in part.
    const std::span<std::byte> rest = parts.front().subspan(static_cast<std::size_t>(got));
    read(rest, offset);
    offset += rest.size();
    parts = parts.subspan(1);
  }
}

std::span<const std::byte> InputFile::map() const {
  void* const begin = mmap(nullptr, size_, PROT_READ, MAP_SHARED, descriptor_, 0);
  if (begin == MAP_FAILED) fail(errno);
  return {static_cast<const std::byte*>(begin), size_};
}

void unmap(std::span<const std::byte> bytes) noexcept { munmap(const_cast<std::byte*>(bytes.data()), bytes.size()); }

JournalFile::JournalFile(const char* path) : descriptor_(open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) fail(errno);
  try {
    // Where the file system has no locks, other objects are not kept out.
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) fail(EAGAIN);
    size_ = size_of_file(descriptor_);
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

JournalFile::~JournalFile() { close(descriptor_); }

void JournalFile::read(std::span<std::byte> bytes, std::uint64_t offset) const { read_at(descriptor_, bytes, offset); }

void JournalFile::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t put = pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(size_));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) fail(errno);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
    size_ += static_cast<std::uint64_t>(put);
  }
}

void JournalFile::cut(std::uint64_t size) {
  if (ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail(errno);
  size_ = size;
}

bool exchange_names([[maybe_unused]] const char* a, [[maybe_unused]] const char* b) noexcept {
#ifdef RENAME_EXCHANGE  // Linux
  return renameat2(AT_FDCWD, a, AT_FDCWD, b, RENAME_EXCHANGE) == 0;
#else
  return false;
#endif
}

}  // namespace occlod
