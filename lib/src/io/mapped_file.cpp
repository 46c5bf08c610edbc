#include "mapped_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "occlod/core/error.h"

namespace occlod {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, int error_number) {
  throw Error({path.string(), "", fmt::format("cannot be opened: {}", std::generic_category().message(error_number)),
               "check that the file is there and can be read"});
}

// Closes a descriptor: a mapping outlives it.
class Descriptor {
 public:
  explicit Descriptor(const std::filesystem::path& path) : fd_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const noexcept { return fd_; }
  // Throws Error that names `path` when it is no regular file.
  [[nodiscard]] std::size_t size(const std::filesystem::path& path) const {
    struct stat status {};
    if (fd_ < 0 || fstat(fd_, &status) != 0) refuse(path, errno);
    if (!S_ISREG(status.st_mode)) refuse(path, S_ISDIR(status.st_mode) ? EISDIR : EINVAL);
    return static_cast<std::size_t>(status.st_size);
  }

 private:
  int fd_;
};

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) {
  const Descriptor file(path);
  const std::size_t size = file.size(path);
  if (size == 0) return;  // an empty mapping is an error
  void* const begin = mmap(nullptr, size, PROT_READ, MAP_SHARED, file.get(), 0);
  if (begin == MAP_FAILED) refuse(path, errno);
  bytes_ = {static_cast<const std::byte*>(begin), size};
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

LargeVector<std::byte> read_whole(const std::filesystem::path& path) {
  const Descriptor file(path);
  LargeVector<std::byte> bytes(file.size(path));
  for (std::size_t have = 0; have < bytes.size();) {
    const ssize_t got = read(file.get(), bytes.data() + have, bytes.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) refuse(path, got < 0 ? errno : EIO);
    have += static_cast<std::size_t>(got);
  }
  return bytes;
}

}  // namespace occlod
