#include "base/atomic_file.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/memory.h"
#include "base/platform.h"
#include "occlod/base.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view hidden_suffix = ".tmp";

// The hidden name takes at most this many bytes of the target's name, which may be as long as the file system allows.
constexpr std::size_t longest_stem = 100;

std::string hidden_prefix(const fs::path& target) {
  const std::string name = target.filename().string();
  std::size_t size = std::min(name.size(), longest_stem);
  const auto continues_a_character = [&](std::size_t i) {
    return (static_cast<unsigned char>(name[i]) & 0xC0U) == 0x80;
  };
  while (size > 0 && size < name.size() && continues_a_character(size)) --size;  // does not cut a UTF-8 character
  return fmt::format(".{}.", name.substr(0, size));
}

// True for a file that a killed process left while it wrote `target`. A process on another machine may be writing in
// the same folder; its file is younger than a minute.
bool is_leftover(const fs::directory_entry& entry, const std::string& prefix) {
  const std::string name = entry.path().filename().string();
  if (!name.starts_with(prefix) || !name.ends_with(hidden_suffix)) return false;
  const char* const end = name.data() + name.size();
  int process = 0;
  const auto [after, error] = std::from_chars(name.data() + prefix.size(), end, process);
  if (error != std::errc() || after == end || *after != '-' || process <= 0) return false;
  if (may_be_running(process)) return false;
  std::error_code unknown;
  const auto age = fs::file_time_type::clock::now() - entry.last_write_time(unknown);
  return !unknown && age > std::chrono::minutes(1);
}

// Returns the hidden name beside `target` under which it is written before it is renamed. It is unique among the
// running processes and among the files of this one. `target` has its links followed.
[[nodiscard]] fs::path hidden_neighbour(const fs::path& target) {
  static std::atomic<unsigned> counter = 0;
  return target.parent_path() / fmt::format("{}{}-{}{}", hidden_prefix(target), process_id(), counter++, hidden_suffix);
}

// Returns the folder of a file, or "." for a path without one.
[[nodiscard]] fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// Removes hidden files beside `target` that killed processes left, once they are a minute old.
void remove_leftovers(const fs::path& target) {
  const std::string prefix = hidden_prefix(target);
  std::error_code ignored;
  for (fs::directory_iterator entry(folder_of(target), ignored); !ignored && entry != fs::directory_iterator();
       entry.increment(ignored))
    if (std::error_code kept; is_leftover(*entry, prefix)) fs::remove_all(entry->path(), kept);
}

[[noreturn]] void fail(const fs::path& path, std::string problem, std::string remedy) {
  throw Error({path.string(), "", std::move(problem), std::move(remedy)});
}

std::string reason(int error_number) { return std::generic_category().message(error_number); }

constexpr std::size_t block_bytes = std::size_t{1} << 22;

thread_local WriteMonitor* innermost_monitor = nullptr;
thread_local WriteGuard* innermost_guard = nullptr;
thread_local FileGroup* innermost_group = nullptr;

// True when nothing has this name.
bool is_free(const fs::path& target) {
  std::error_code unknown;
  return !fs::exists(fs::symlink_status(target, unknown));
}

// Exchanges a hidden file or folder with its target, which exists. On success `hidden` is where the old one is now.
[[nodiscard]] std::error_code exchange(fs::path& hidden, const fs::path& target) {
  std::error_code error;
  if (exchange_names(hidden.c_str(), target.c_str())) return error;
  // The file system cannot swap names: for a moment nothing has the target's name.
  const fs::path old = hidden_neighbour(target);
  fs::rename(target, old, error);
  if (error) return error;
  fs::rename(hidden, target, error);
  std::error_code ignored;
  if (error)
    fs::rename(old, target, ignored);
  else
    hidden = old;
  return error;
}

[[noreturn]] void fail_to_replace(const fs::path& path, const std::error_code& error) {
  fail(path, fmt::format("cannot be replaced: {}", error.message()),
       "check the permissions of the folder that it is in");
}

// Returns the status of `path` with links followed; throws when no file can be there.
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
  (void)status_of(path);  // throws for links that lead back to themselves
  std::error_code ignored;
  while (fs::is_symlink(fs::symlink_status(target, ignored)))
    target = target.parent_path() / fs::read_symlink(target, ignored);
  return target;
}

AtomicFile::AtomicFile(fs::path path) : path_(std::move(path)), target_(target_of(path_)) {
  require_writable(path_, target_);
  WriteGuard::check(path_);
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
    make_room();  // the array behind `bytes` may have filled memory
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
  if (innermost_group != nullptr) {
    innermost_group->files_.push_back({path_, target_, temporary_});
  } else {
    std::error_code error;
    fs::rename(temporary_, target_, error);
    if (error) fail_to_replace(path_, error);
  }
  temporary_.clear();
}

void AtomicFile::fail_to_write() const {
  fail(path_, fmt::format("cannot be written: {}", reason(errno != 0 ? errno : EIO)), "check the space on the disk");
}

FileGroup::FileGroup() : outer_(innermost_group) { innermost_group = this; }

FileGroup::~FileGroup() {
  innermost_group = outer_;
  std::error_code ignored;
  for (const Waiting& file : files_) fs::remove(file.hidden, ignored);
}

void FileGroup::commit() {
  if (outer_ != nullptr) {
    outer_->files_.insert(outer_->files_.end(), files_.begin(), files_.end());
    files_.clear();
    return;
  }
  for (; in_place_ < files_.size(); ++in_place_) {
    Waiting& file = files_[in_place_];
    file.is_new = is_free(file.target);
    std::error_code error;
    // The last one need not be taken back, so the old file need not be kept.
    if (file.is_new || in_place_ + 1 == files_.size())
      fs::rename(file.hidden, file.target, error);
    else
      error = exchange(file.hidden, file.target);
    if (!error) continue;
    take_back();
    fail_to_replace(file.path, error);
  }
}

// In reverse, so that a file that was written twice gets its first content back.
void FileGroup::take_back() noexcept {
  std::error_code ignored;
  while (in_place_ > 0) {
    const Waiting& file = files_[--in_place_];
    if (file.is_new)
      fs::remove(file.target, ignored);
    else
      fs::rename(file.hidden, file.target, ignored);
  }
}

WriteGuard::WriteGuard(Check check) : check_(std::move(check)), outer_(innermost_guard) { innermost_guard = this; }

WriteGuard::~WriteGuard() { innermost_guard = outer_; }

void WriteGuard::check(const fs::path& path) {
  if (innermost_guard != nullptr) innermost_guard->check_(path);
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

namespace {

// Removes a slash at the end, which would leave an empty file name.
fs::path without_slash(fs::path path) {
  if (path.filename().empty() && path.has_parent_path() && path != path.root_path()) path = path.parent_path();
  return path;
}

void require_writable_folder(const fs::path& path, const fs::path& target) {
  if (path.empty()) throw Error({"output folder", "", "has no name", "name a folder"});
  std::error_code unknown;
  const fs::file_status status = fs::status(target, unknown);
  if (unknown == std::errc::filename_too_long) fail(path, "the name is too long", "choose a shorter one");
  if (fs::exists(status) && !fs::is_directory(status)) fail(path, "is not a folder", "choose another name");
  if (target.filename().empty() || target.filename() == "." || target.filename() == "..")
    fail(path, "cannot be replaced by a new folder", "name a folder in it");
  if (is_mount_point(target.c_str()))
    fail(path, "is a mount point, which cannot be replaced by a new folder", "name a folder in it");
  const fs::path folder = folder_of(target);
  if (!fs::is_directory(folder, unknown))
    fail(path, fmt::format("the folder {} does not exist", folder.string()), "create it first");
  if (const int why_not = why_no_files_can_be_made(folder.c_str()); why_not != 0)
    fail(path, fmt::format("cannot be written: {}", std::generic_category().message(why_not)),
         "check the permissions of the folder that it is in");
}

}  // namespace

void AtomicFolder::check(const fs::path& path) {
  require_writable_folder(path, AtomicFile::target_of(without_slash(path)));
}

AtomicFolder::AtomicFolder(fs::path path)
    : path_(std::move(path)), target_(AtomicFile::target_of(without_slash(path_))) {
  require_writable_folder(path_, target_);
  WriteMonitor::notify(0);
  remove_leftovers(target_);
  const fs::path hidden = hidden_neighbour(target_);
  std::error_code error;
  if (!fs::create_directory(hidden, error)) fail_to_write(error.value());
  temporary_ = hidden;
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void AtomicFolder::write(const std::string& name, std::string_view bytes) {
  WriteGuard::check(target_ / name);
  WriteMonitor::notify(bytes_);
  errno = 0;
  std::ofstream stream(place(name), std::ios::binary | std::ios::trunc);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) fail_to_write(errno);
  bytes_ += bytes.size();
}

void AtomicFolder::commit() {
  WriteMonitor::notify(bytes_);
  std::error_code error;
  if (is_free(target_)) {
    fs::rename(temporary_, target_, error);
    if (!error) temporary_.clear();
  } else {
    error = exchange(temporary_, target_);
  }
  if (error) fail_to_replace(path_, error);
}

fs::path AtomicFolder::place(const std::string& name) {
  const fs::path file = temporary_ / name;
  if (made_.insert(file.parent_path()).second) {
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    if (error) fail_to_write(error.value());
  }
  return file;
}

void AtomicFolder::fail_to_write(int error_number) const {
  const std::string reason = std::generic_category().message(error_number != 0 ? error_number : EIO);
  fail(path_, fmt::format("cannot be written: {}", reason), "check the space on the disk");
}

}  // namespace occlod
