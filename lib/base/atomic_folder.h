// A folder that appears whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>

namespace occlod {

// Is written as a hidden folder beside `path`; commit() renames it to `path`, in place of a folder that is there.
// Without commit() the destructor removes it and `path` stays as it was; what a killed process has left is removed by
// the next that writes the same `path`, when it is a minute old. A symbolic link at `path` is followed. Throws Error
// that names `path`. WriteMonitor watches it like an AtomicFile.
class AtomicFolder {
 public:
  // Throws what the constructor throws and changes nothing: for programs that compute for long before they write.
  static void check(const std::filesystem::path& path);

  explicit AtomicFolder(std::filesystem::path path);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  // A file in it, whose folders are made. `name`: relative, new.
  void write(const std::string& name, std::string_view bytes);
  // Written so far.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  void commit();

 private:
  [[nodiscard]] std::filesystem::path place(const std::string& name);
  [[noreturn]] void fail_to_write(int error_number) const;

  std::filesystem::path path_;       // as given
  std::filesystem::path target_;     // with symbolic links followed
  std::filesystem::path temporary_;  // what the destructor removes: what is written, or after commit() what was there
  std::set<std::filesystem::path> made_;  // folders in it
  std::uint64_t bytes_ = 0;
};

}  // namespace occlod
