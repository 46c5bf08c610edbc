#include "io/file_input.h"

#include <fmt/format.h>

#include <fstream>
#include <system_error>
#include <utility>

#include "occlod/core/error.h"

namespace occlod {
namespace fs = std::filesystem;

void FileErrors::fail(std::string place, std::string problem, std::string mend) const {
  throw Error({subject_, std::move(place), std::move(problem), std::move(mend)});
}

void FileErrors::fail_at_line(std::uint64_t line, std::string problem, std::string mend) const {
  fail(fmt::format("line {}", line), std::move(problem), std::move(mend));
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string shown = "'";
  for (const char c : text.substr(0, longest)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown + (text.size() > longest ? "...'" : "'");
}

std::string read_file(const fs::path& path, const FileErrors& errors) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) errors.fail("", "no such file", "check the path");
  if (fs::is_directory(status)) errors.fail("", "is a folder", "name a mesh file in it");
  if (!fs::is_regular_file(status)) errors.fail("", "is not a regular file", "save the mesh to a file first");
  const std::uintmax_t size = fs::file_size(path, error);
  std::ifstream stream(path, std::ios::binary);
  if (error || !stream) errors.fail("", "cannot be opened", "check its permissions");
  if (size == 0) errors.fail("", "is empty", "export the mesh again");
  std::string bytes(size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size) {
    errors.fail(fmt::format("byte {}", stream.gcount()), "cannot be read further", "check the disk");
  }
  return bytes;
}

}  // namespace occlod
