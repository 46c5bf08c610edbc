// Reads files: mapped, as a whole, or block by block, with errors that name the file.
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

// Throws Error for a pipe, a device or a socket, which would keep a reader waiting or never end.
void require_no_special_file(const std::filesystem::path& path);

class MappedFile {
 public:
  // Throws Error when there is no such regular file or it cannot be mapped.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  // Returns the bytes of the file. They start at a page, so at any alignment; pages are loaded when they are first
  // read.
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

// Reads the whole file into memory that is aligned to 64 bytes. Throws Error when there is no such regular file or not
// all of it can be read.
[[nodiscard]] LargeVector<std::byte> read_whole(const std::filesystem::path& path);

// Opens a file to be read in parts; it stays readable when its name is removed or replaced. Throws Error when there is
// no such regular file.
[[nodiscard]] std::shared_ptr<const InputFile> open_file(const std::filesystem::path& path);

// Makes the errors of one file, which all name it.
class FileErrors {
 public:
  explicit FileErrors(const std::filesystem::path& path) : subject_(path.string()) {}

  [[nodiscard]] const std::string& subject() const noexcept { return subject_; }
  [[noreturn]] void fail(std::string place, std::string problem, std::string remedy) const;
  [[noreturn]] void fail_at_line(std::uint64_t line, std::string problem, std::string remedy) const;

 private:
  std::string subject_;
};

// Returns `text` in quotation marks for a message: on one line, printable and short.
[[nodiscard]] std::string in_quotes(std::string_view text);

// The bytes of a file or of a text in memory, read once from beginning to end.
class InputBytes {
 public:
  // Throws Error for a file that is missing, empty, not regular or not readable. `progress` is called before each block
  // with the share of the file that has been read, in [0, 1].
  InputBytes(const std::filesystem::path& path, const FileErrors& errors, std::function<void(double)> progress);
  // Reads `bytes`, which must outlive this object.
  explicit InputBytes(std::string_view bytes) : size_(bytes.size()), window_(bytes) {}

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  // Returns the position of the window's first byte in the file or text.
  [[nodiscard]] std::uint64_t offset() const noexcept { return offset_; }

  // Returns the bytes from the current position on: at least `least`, or all that are left. The view is valid until the
  // next call. Throws Error when the file cannot be read.
  [[nodiscard]] std::string_view window(std::size_t least);
  // Advances by `count` bytes, at most the size of the window.
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
  std::unique_ptr<char[]> buffer_;  // the block buffer of a file; null for a text
  std::size_t capacity_ = 0;
  std::string_view window_;  // points into buffer_, or is the rest of the text
};

}  // namespace occlod
