#include "occlod/io/atomic_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

#include "occlod/core/error.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, std::string problem, std::string mend) {
  throw Error({path.string(), "", std::move(problem), std::move(mend)});
}

std::string reason(int error_number) { return std::generic_category().message(error_number); }

constexpr std::size_t block_bytes = std::size_t{1} << 22;

thread_local WriteMonitor* innermost_monitor = nullptr;

// Unique among the running processes and among the files of this one.
fs::path hidden_neighbour(const fs::path& target) {
  static std::atomic<unsigned> counter = 0;
  return target.parent_path() / fmt::format(".{}.{}-{}.tmp", target.filename().string(), getpid(), counter++);
}

}  // namespace

AtomicFile::AtomicFile(fs::path path) : path_(std::move(path)) {
  std::error_code ignored;
  target_ = fs::is_symlink(path_, ignored) ? fs::weakly_canonical(path_, ignored) : path_;
  const fs::file_status status = fs::status(target_, ignored);
  if (target_.filename().empty() || fs::is_directory(status)) fail(path_, "is a folder", "name a file in it");
  if (fs::exists(status) && !fs::is_regular_file(status)) fail(path_, "is not a regular file", "choose another name");
  const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) {
    fail(path_, fmt::format("the folder {} does not exist", folder.string()), "create it first");
  }
  WriteMonitor::notify(0);
  temporary_ = hidden_neighbour(target_);
  errno = 0;
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) {
    const std::string why = reason(errno);
    temporary_.clear();
    fail(path_, fmt::format("cannot be written: {}", why), "check the permissions of the folder");
  }
  if (fs::exists(status)) fs::permissions(temporary_, status.permissions(), ignored);
}

AtomicFile::~AtomicFile() {
  if (temporary_.empty()) return;
  stream_.close();
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    WriteMonitor::notify(written_);
    const std::span<const std::byte> block = bytes.first(std::min(bytes.size(), block_bytes));
    stream_.write(reinterpret_cast<const char*>(block.data()), static_cast<std::streamsize>(block.size()));
    written_ += block.size();
    bytes = bytes.subspan(block.size());
  }
}

void AtomicFile::commit() {
  WriteMonitor::notify(written_);
  errno = 0;
  stream_.close();
  if (!stream_) {
    fail(path_, fmt::format("cannot be written: {}", reason(errno != 0 ? errno : EIO)), "check the space on the disk");
  }
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) fail(path_, fmt::format("cannot be replaced: {}", error.message()), "check the permissions of the folder");
  temporary_.clear();
}

WriteMonitor::WriteMonitor(Progress progress) : progress_(std::move(progress)), outer_(innermost_monitor) {
  innermost_monitor = this;
}

WriteMonitor::~WriteMonitor() { innermost_monitor = outer_; }

void WriteMonitor::notify(std::uint64_t bytes) {
  if (innermost_monitor != nullptr) innermost_monitor->progress_(bytes);
}

}  // namespace occlod
