#include "base/atomic_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include "base/exchange_names.h"
#include "base/platform.h"
#include "base/atomic_file.h"
#include "base/hidden_neighbour.h"
#include "occlod/core/error.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, std::string problem, std::string remedy) {
  throw Error({path.string(), "", std::move(problem), std::move(remedy)});
}

// Without a slash at its end, which would leave no name.
fs::path without_slash(fs::path path) {
  if (path.filename().empty() && path.has_parent_path() && path != path.root_path()) path = path.parent_path();
  return path;
}

void require_writable(const fs::path& path, const fs::path& target) {
  if (path.empty()) throw Error({"output folder", "", "has no name", "name a folder"});
  std::error_code unknown;
  const fs::file_status status = fs::status(target, unknown);
  if (unknown == std::errc::filename_too_long) fail(path, "the name is too long", "choose a shorter one");
  if (fs::exists(status) && !fs::is_directory(status)) fail(path, "is not a folder", "choose another name");
  if (target.filename().empty() || target.filename() == "." || target.filename() == "..")
    fail(path, "cannot be replaced by a new folder", "name a folder in it");
  const fs::path folder = folder_of(target);
  if (!fs::is_directory(folder, unknown))
    fail(path, fmt::format("the folder {} does not exist", folder.string()), "create it first");
  if (const int why_not = why_no_files_can_be_made(folder.c_str()); why_not != 0)
    fail(path, fmt::format("cannot be written: {}", std::generic_category().message(why_not)),
         "check the permissions of the folder that it is in");
}

// Under whose name nothing is.
bool is_free(const fs::path& target) {
  std::error_code unknown;
  return !fs::exists(fs::symlink_status(target, unknown));
}

}  // namespace

void AtomicFolder::check(const fs::path& path) { require_writable(path, AtomicFile::target_of(without_slash(path))); }

AtomicFolder::AtomicFolder(fs::path path)
    : path_(std::move(path)), target_(AtomicFile::target_of(without_slash(path_))) {
  require_writable(path_, target_);
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
  } else if (!exchange_names(temporary_.c_str(), target_.c_str())) {
    // The file system cannot do it at once: for a moment nothing has the name.
    const fs::path old = hidden_neighbour(target_);
    fs::rename(target_, old, error);
    if (!error) {
      fs::rename(temporary_, target_, error);
      std::error_code ignored;
      if (error)
        fs::rename(old, target_, ignored);
      else
        temporary_ = old;  // for the destructor
    }
  }
  if (error)
    fail(path_, fmt::format("cannot be replaced: {}", error.message()), "check the permissions of the folder it is in");
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
