// A file's bytes in memory without reading them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/memory.h"
#include "base/platform.h"

namespace occlod {

class MappedFile {
 public:
  // Throws Error when there is no such regular file, or it cannot be mapped.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  // Starts at a page, so at any alignment. Pages are loaded when they are first read.
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

// The same bytes in memory, at any alignment up to 64. Throws Error likewise, and when they cannot all be read.
[[nodiscard]] LargeVector<std::byte> read_whole(const std::filesystem::path& path);

// A file to be read in parts, whatever becomes of its name. Throws Error when there is no such regular file.
[[nodiscard]] std::shared_ptr<const InputFile> open_file(const std::filesystem::path& path);

// A file read in blocks or as a whole, and errors that name it.

// Makes the errors of one file.
class FileErrors {
 public:
  explicit FileErrors(const std::filesystem::path& path) : subject_(path.string()) {}

  [[nodiscard]] const std::string& subject() const noexcept { return subject_; }
  [[noreturn]] void fail(std::string place, std::string problem, std::string remedy) const;
  [[noreturn]] void fail_at_line(std::uint64_t line, std::string problem, std::string remedy) const;

 private:
  std::string subject_;
};

// `text` in quotation marks, on one line, printable and short, for messages.
[[nodiscard]] std::string in_quotes(std::string_view text);

// The bytes of a file, or of a text in memory, from its beginning to its end.
class InputBytes {
 public:
  // Throws Error for a file that is missing, empty, not regular or not readable. `progress` is called before each
  // block with the share that has been read.
  InputBytes(const std::filesystem::path& path, const FileErrors& errors, std::function<void(double)> progress);
  // `bytes` outlives it.
  explicit InputBytes(std::string_view bytes) : size_(bytes.size()), window_(bytes) {}

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  // Of the window's first byte.
  [[nodiscard]] std::uint64_t offset() const noexcept { return offset_; }

  // The bytes from here on: `least` or more, or all that are left. Valid until the next call. Throws Error when the
  // file cannot be read.
  [[nodiscard]] std::string_view window(std::size_t least);
  // Goes on by `count` bytes, no more than the window has.
  void skip(std::size_t count) {
    window_.remove_prefix(count);
    offset_ += count;
  }

 private:
  void read_to(std::size_t bytes);

  const FileErrors* errors_ = nullptr;
  std::function<void(double)> progress_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t offset_ = 0;
  std::unique_ptr<char[]> buffer_;  // of a file
  std::size_t capacity_ = 0;
  std::string_view window_;  // into buffer_, or what is left of the text
};

}  // namespace occlod
