// A file read as a whole, and errors that name it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace occlod {

// Makes the errors of one file.
class FileErrors {
 public:
  explicit FileErrors(const std::filesystem::path& path) : subject_(path.string()) {}

  [[nodiscard]] const std::string& subject() const noexcept { return subject_; }
  [[noreturn]] void fail(std::string place, std::string problem, std::string mend) const;
  [[noreturn]] void fail_at_line(std::uint64_t line, std::string problem, std::string mend) const;

 private:
  std::string subject_;
};

// `text` in quotation marks, on one line, printable and short, for messages.
[[nodiscard]] std::string in_quotes(std::string_view text);

// All bytes of a regular file. Throws Error for a file that is missing, empty, not regular or not readable.
[[nodiscard]] std::string read_file(const std::filesystem::path& path, const FileErrors& errors);

}  // namespace occlod
