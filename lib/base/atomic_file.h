// AtomicFile and AtomicFolder make a file or a folder appear at its path complete or not at all.
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
// commit() the destructor removes the hidden file and `path` stays as it was. Hidden files left by killed processes are
// removed by the next AtomicFile for the same `path`, once they are a minute old. Symbolic links are followed, even to
// a file that does not exist yet; a folder, a device or a pipe is refused. Throws Error that names `path`.
class AtomicFile {
 public:
  // Throws what the constructor would throw and changes nothing, so that a long computation can fail before it starts.
  static void check(const std::filesystem::path& path);
  // Returns the file that is written for `path`, with its symbolic links followed. Throws Error when they lead nowhere.
  [[nodiscard]] static std::filesystem::path target_of(const std::filesystem::path& path);

  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] std::ostream& stream() noexcept { return stream_; }
  void write(std::span<const std::byte> bytes);
  void commit();

 private:
  [[noreturn]] void fail_to_write() const;  // takes the reason from errno

  std::filesystem::path path_;       // as given
  std::filesystem::path target_;     // with symbolic links followed
  std::filesystem::path temporary_;  // empty after commit()
  std::ofstream stream_;
  std::uint64_t written_ = 0;  // bytes passed to write()
};

// Returns a string that is equal for all names of one file, with symbolic links followed: its device and file number
// or, if nothing exists there yet, its name without links. Use it for comparison only. Does not throw for links that
// lead nowhere: writing the file reports them.
[[nodiscard]] std::string identity_of(const std::filesystem::path& path);

// Watches all AtomicFiles of this thread while it lives, whatever code writes them. `progress` is called before a file
// is opened, before each block of write() and before commit() renames it, with the number of bytes that write() has
// taken so far. An exception from `progress` passes through the AtomicFile, whose destructor then removes the file. Of
// nested monitors only the innermost is called.
class WriteMonitor {
 public:
  using Progress = std::function<void(std::uint64_t bytes)>;

  explicit WriteMonitor(Progress progress);
  ~WriteMonitor();
  WriteMonitor(const WriteMonitor&) = delete;
  WriteMonitor& operator=(const WriteMonitor&) = delete;

  // Calls this thread's monitor, if there is one.
  static void notify(std::uint64_t bytes);

 private:
  Progress progress_;
  WriteMonitor* outer_;
};

// Writes a hidden folder beside `path`; commit() renames it to `path` and replaces a folder that is there. Without
// commit() the destructor removes the hidden folder and `path` stays as it was. Hidden folders left by killed processes
// are removed by the next AtomicFolder for the same `path`, once they are a minute old. A symbolic link at `path` is
// followed. Throws Error that names `path`. A WriteMonitor watches it like an AtomicFile.
class AtomicFolder {
 public:
  // Throws what the constructor would throw and changes nothing, so that a long computation can fail before it starts.
  static void check(const std::filesystem::path& path);

  explicit AtomicFolder(std::filesystem::path path);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  // Writes a file in the folder and makes the folders on its way. `name` is relative and new.
  void write(const std::string& name, std::string_view bytes);
  // Returns the number of bytes written so far.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  void commit();

 private:
  [[nodiscard]] std::filesystem::path place(const std::string& name);
  [[noreturn]] void fail_to_write(int error_number) const;

  std::filesystem::path path_;       // as given
  std::filesystem::path target_;     // with symbolic links followed
  std::filesystem::path temporary_;  // what the destructor removes: the hidden folder or, after commit(), the folder
                                     // that was replaced
  std::set<std::filesystem::path> made_;  // folders made so far inside it
  std::uint64_t bytes_ = 0;
};

}  // namespace occlod
