// AtomicFile and AtomicFolder make a file or a folder appear at its path complete or not at all, FileGroup does so for
// several files.
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
#include <vector>

namespace occlod {

// Writes to a hidden file beside `path`; commit() flushes it, checks for errors and renames it over `path`. Without
// commit() the destructor removes the hidden file and `path` stays as it was. Hidden files left by killed processes are
// removed by the next AtomicFile for the same `path`, once they are a minute old. Symbolic links are followed, even to
// a file that does not exist yet; a folder, a device or a pipe is refused. Where a FileGroup lives, commit() leaves the
// renaming to it. Throws Error that names `path`.
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

// Makes files that belong together appear together: while it lives, what AtomicFiles of this thread commit waits in
// hidden files, until commit() renames all of them or, when one cannot be renamed, none. Without commit() the
// destructor removes them. A group within another hands its files on to that. Only a process that is killed while
// commit() renames can leave some files new and others old.
class FileGroup {
 public:
  FileGroup();
  ~FileGroup();
  FileGroup(const FileGroup&) = delete;
  FileGroup& operator=(const FileGroup&) = delete;

  // Throws Error that names the file that cannot be replaced.
  void commit();

 private:
  friend class AtomicFile;

  struct Waiting {
    std::filesystem::path path, target, hidden;  // `hidden` holds the new file or, once it is in place, the old one
    bool is_new = false;                         // nothing had the target's name
  };
  void take_back() noexcept;

  std::vector<Waiting> files_;
  std::size_t in_place_ = 0;  // number of files that have been renamed
  FileGroup* outer_;
};

// Shows a program all files that this thread is about to write, whatever code writes them, so that it can refuse some:
// `check` is called with the path of each file before anything of it is written, and may throw. Of nested guards only
// the innermost is called.
class WriteGuard {
 public:
  using Check = std::function<void(const std::filesystem::path& path)>;

  explicit WriteGuard(Check check);
  ~WriteGuard();
  WriteGuard(const WriteGuard&) = delete;
  WriteGuard& operator=(const WriteGuard&) = delete;

  // Calls this thread's guard, if there is one.
  static void check(const std::filesystem::path& path);

 private:
  Check check_;
  WriteGuard* outer_;
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
