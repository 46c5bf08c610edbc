#include "base/atomic_file.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "base/platform.h"
#include "base/scratch_memory.h"
#include "base/hidden_neighbour.h"
#include "occlod/core/error.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, std::string problem, std::string remedy) {
  throw Error({path.string(), "", std::move(problem), std::move(remedy)});
}

std::string reason(int error_number) { return std::generic_category().message(error_number); }

constexpr std::size_t block_bytes = std::size_t{1} << 22;

thread_local WriteMonitor* innermost_monitor = nullptr;

// Of what is at `path`, links followed; throws when nothing could be there.
fs::file_status status_of(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (error == std::errc::filename_too_long) fail(path, "the name is too long", "choose a shorter one");
  if (error == std::errc::too_many_symbolic_link_levels)
    fail(path, "is a symbolic link that leads back to itself", "remove the link or choose another name");
  return status;
}

void require_writable(const fs::path& path, const fs::path& target) {
  if (path.empty()) throw Error({"output file", "", "has no name", "name a file"});
  const fs::file_status status = status_of(path);
  if (target.filename().empty() || fs::is_directory(status)) fail(path, "is a folder", "name a file in it");
  if (fs::exists(status) && !fs::is_regular_file(status)) fail(path, "is not a regular file", "choose another name");
  const fs::path folder = folder_of(target);
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    fail(path, fmt::format("the folder {} does not exist", folder.string()), "create it first");
  if (const int why_not = why_no_files_can_be_made(folder.c_str()); why_not != 0)
    fail(path, fmt::format("cannot be written: {}", reason(why_not)), "check the permissions of the folder");
}

}  // namespace

void AtomicFile::check(const fs::path& path) { require_writable(path, target_of(path)); }

fs::path AtomicFile::target_of(const fs::path& path) {
  fs::path target = path;
  (void)status_of(path);  // links that lead back to themselves end here
  std::error_code ignored;
  while (fs::is_symlink(fs::symlink_status(target, ignored)))
    target = target.parent_path() / fs::read_symlink(target, ignored);
  return target;
}

AtomicFile::AtomicFile(fs::path path) : path_(std::move(path)), target_(target_of(path_)) {
  require_writable(path_, target_);
  WriteMonitor::notify(0);
  remove_leftovers(target_);
  temporary_ = hidden_neighbour(target_);
  errno = 0;
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) {
    const std::string why = reason(errno);
    temporary_.clear();
    fail(path_, fmt::format("cannot be written: {}", why), "check the permissions of the folder");
  }
  std::error_code ignored;
  const fs::file_status status = fs::status(target_, ignored);
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
    make_room();  // which `bytes` may take
    const std::span<const std::byte> block = bytes.first(std::min(bytes.size(), block_bytes));
    errno = 0;
    stream_.write(reinterpret_cast<const char*>(block.data()), static_cast<std::streamsize>(block.size()));
    if (!stream_) fail_to_write();
    written_ += block.size();
    bytes = bytes.subspan(block.size());
  }
}

void AtomicFile::commit() {
  WriteMonitor::notify(written_);
  errno = 0;
  stream_.close();
  if (!stream_) fail_to_write();
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) fail(path_, fmt::format("cannot be replaced: {}", error.message()), "check the permissions of the folder");
  temporary_.clear();
}

void AtomicFile::fail_to_write() const {
  fail(path_, fmt::format("cannot be written: {}", reason(errno != 0 ? errno : EIO)), "check the space on the disk");
}

std::string identity_of(const fs::path& path) {
  struct stat found {};
  if (stat(path.c_str(), &found) == 0) return fmt::format("{}:{}", found.st_dev, found.st_ino);
  std::error_code ignored;
  try {
    return fs::weakly_canonical(fs::absolute(AtomicFile::target_of(path), ignored), ignored).string();
  } catch (const Error&) {
    return path.string();
  }
}

WriteMonitor::WriteMonitor(Progress progress) : progress_(std::move(progress)), outer_(innermost_monitor) {
  innermost_monitor = this;
}

WriteMonitor::~WriteMonitor() { innermost_monitor = outer_; }

void WriteMonitor::notify(std::uint64_t bytes) {
  if (innermost_monitor != nullptr) innermost_monitor->progress_(bytes);
}

}  // namespace occlod
