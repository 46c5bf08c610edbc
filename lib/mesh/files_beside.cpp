#include "mesh/files_beside.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "base/hex_digit.h"
#include "mesh/file_format.h"
#include "base/file_input.h"
#include "mesh/gltf_buffers.h"
#include "mesh/parse_mtl.h"
#include "mesh/text_chunks.h"
#include "base/text_cursor.h"
#include "base/text_encoding.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code unknown;
  return fs::is_regular_file(path, unknown);
}

std::string_view without_quotes(std::string_view name) {
  const bool quoted = name.size() >= 2 && name.front() == '"' && name.back() == '"';
  return quoted ? name.substr(1, name.size() - 2) : name;
}

// Looks at no line without the keyword: files are large, and have one such line or none.
std::vector<fs::path> libraries_of(InputBytes& input, const fs::path& folder, const FileErrors& errors) {
  constexpr std::string_view keyword = "mtllib";
  std::vector<fs::path> files;
  TextChunks chunks(input, errors, obj_syntax);
  for (std::string_view lines; chunks.next(lines);) {
    for (std::size_t at = lines.find(keyword); at != std::string_view::npos;
         at = lines.find(keyword, at + keyword.size())) {
      const std::size_t line = lines.find_last_of("\r\n", at) + 1;  // 0 where there is none before
      TextCursor cursor(lines.substr(line), errors, obj_syntax);
      if (!cursor.find_word() || cursor.word() != keyword) continue;
      for (const std::string& name : library_names(cursor.rest_of_line(), folder)) files.push_back(folder / name);
    }
  }
  return files;
}

std::vector<fs::path> buffers_of(std::string_view bytes, const fs::path& folder) {
  using Json = nlohmann::json;
  const Json json = Json::parse(gltf_text(bytes), nullptr, false);
  std::vector<fs::path> files;
  if (!json.is_object() || !json.contains("buffers") || !json["buffers"].is_array()) return files;
  for (const Json& buffer : json["buffers"]) {
    if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string()) continue;
    fs::path file = folder / file_name_of_uri(buffer["uri"].get<std::string>());
    if (is_file(file)) files.push_back(std::move(file));
  }
  return files;
}

}  // namespace

std::vector<fs::path> files_beside(const fs::path& mesh) {
  const FileErrors errors(mesh);
  const std::optional<MeshFormat> format = find_format(mesh);
  if (format != MeshFormat::obj && format != MeshFormat::gltf) return {};
  InputBytes input(mesh, errors, {});
  if (format == MeshFormat::gltf) return buffers_of(input.window(input.size()), mesh.parent_path());
  input.skip(utf8_mark_bytes(input.window(1)));
  if (!is_wide_text(input.window(1))) return libraries_of(input, mesh.parent_path(), errors);
  std::string converted;
  InputBytes text(as_utf8(input.window(input.size()), converted, errors));
  return libraries_of(text, mesh.parent_path(), errors);
}

std::vector<std::string> library_names(std::string_view line, const fs::path& folder) {
  std::string whole = with_slashes(without_quotes(line));
  if (is_file(folder / whole)) return {std::move(whole)};
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin < line.size();) {
    const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    std::string name = with_slashes(without_quotes(line.substr(begin, end - begin)));
    if (!name.empty() && is_file(folder / name)) names.push_back(std::move(name));
    begin = end + 1;
  }
  return names;
}

std::string file_name_of_uri(std::string_view uri) {
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
    if (low < 0) {
      name += uri[i];
      continue;
    }
    name += static_cast<char>(16 * high + low);
    i += 2;
  }
  return name;
}

}  // namespace occlod
