// A file that appears whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>

namespace occlod {

// Writes to a hidden file beside `path`; commit() flushes it, checks for errors and renames it over `path`. Without
// commit() the destructor removes it and `path` stays as it was; what a killed process has left is removed by the next
// that writes the same `path`, when it is a minute old. Symbolic links are followed, also to a file that does not exist
// yet; a folder, a device or a pipe is refused. Throws Error that names `path`.
class AtomicFile {
 public:
  // Throws what the constructor throws and changes nothing: for programs that compute for long before they write.
  static void check(const std::filesystem::path& path);
  // The file that is written for `path`: where its symbolic links lead. Throws Error when they lead nowhere.
  [[nodiscard]] static std::filesystem::path target_of(const std::filesystem::path& path);

  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] std::ostream& stream() noexcept { return stream_; }
  void write(std::span<const std::byte> bytes);
  void commit();

 private:
  [[noreturn]] void fail_to_write() const;  // for the reason in errno

  std::filesystem::path path_;       // as given
  std::filesystem::path target_;     // with symbolic links followed
  std::filesystem::path temporary_;  // empty after commit()
  std::ofstream stream_;
  std::uint64_t written_ = 0;  // bytes, by write()
};

// The same for every name of one file, links followed: its number on its device, or, where nothing exists yet, its name
// without links. For comparison only. Does not throw for links that lead nowhere: whoever writes the file will say so.
[[nodiscard]] std::string identity_of(const std::filesystem::path& path);

// Watches the AtomicFiles of this thread while it lives, through whatever writes them: `progress` is called before a
// file is begun, before each block of write() and before commit() puts it in place, with the bytes that write() has
// taken so far. What it throws leaves the AtomicFile, whose destructor removes the file. Of nested monitors the
// innermost is called.
class WriteMonitor {
 public:
  using Progress = std::function<void(std::uint64_t bytes)>;

  explicit WriteMonitor(Progress progress);
  ~WriteMonitor();
  WriteMonitor(const WriteMonitor&) = delete;
  WriteMonitor& operator=(const WriteMonitor&) = delete;

  // Calls the monitor of this thread, if there is one.
  static void notify(std::uint64_t bytes);

 private:
  Progress progress_;
  WriteMonitor* outer_;
};

// A folder that appears whole or not at all.

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
