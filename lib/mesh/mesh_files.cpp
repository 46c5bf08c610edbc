#include "mesh/mesh_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/file_input.h"
#include "base/strict_json.h"
#include "base/text.h"
#include "mesh/materials.h"
#include "mesh/polygon_soup.h"
#include "occlod/mesh_file.h"

namespace occlod {
namespace {

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace

std::optional<MeshFormat> find_format(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  if (extension == ".ply") return MeshFormat::ply;
  if (extension == ".obj") return MeshFormat::obj;
  if (extension == ".off") return MeshFormat::off;
  if (extension == ".stl") return MeshFormat::stl;
  if (extension == ".gltf" || extension == ".glb") return MeshFormat::gltf;
  return std::nullopt;
}

MeshFormat format_of(const std::filesystem::path& path, const FileErrors& errors) {
  if (const std::optional<MeshFormat> format = find_format(path)) return *format;
  const std::string extension = extension_of(path);
  errors.fail("",
              extension.empty() ? "has no extension" : fmt::format("the extension {} is unknown", in_quotes(extension)),
              "use .ply, .obj, .off, .stl or, to read, .gltf or .glb");
}

namespace {

using Json = nlohmann::json;

constexpr const char* extension = "EXT_meshopt_compression";
constexpr std::size_t header_bytes = 20;  // size of the headers of a binary file and its first chunk

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
  return load<std::uint32_t>(bytes.data() + offset, std::endian::little);
}

bool is_binary(std::string_view bytes) { return bytes.substr(0, 4) == "glTF"; }

// Returns an empty text when nothing has to be replaced or the text is not JSON.
std::string with_placeholders(std::string_view text, bool has_chunk) {
  if (text.find(extension) == std::string_view::npos || is_nested_too_deeply(text)) return {};
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("buffers") || !json["buffers"].is_array()) return {};
  bool changed = false;
  std::size_t index = 0;
  for (Json& buffer : json["buffers"]) {
    const bool is_chunk = has_chunk && index++ == 0;
    if (is_chunk || !buffer.is_object() || buffer.contains("uri")) continue;
    buffer["byteLength"] = 1;
    buffer["uri"] = "data:application/octet-stream;base64,AA==";
    changed = true;
  }
  return changed ? json.dump(-1, ' ', false, Json::error_handler_t::replace) : std::string();
}

void append_word(std::string& bytes, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xffU);
}

}  // namespace

std::string_view gltf_text(std::string_view bytes) {
  if (!is_binary(bytes)) return bytes;
  if (bytes.size() < header_bytes || word_at(bytes, 12) > bytes.size() - header_bytes) return {};
  return bytes.substr(header_bytes, word_at(bytes, 12));
}

std::string_view with_missing_buffers(std::string_view bytes, std::string& patched) {
  if (!is_binary(bytes)) {
    patched = with_placeholders(bytes, false);
    return patched.empty() ? bytes : patched;
  }
  const std::size_t chunk = gltf_text(bytes).size();
  std::string text = with_placeholders(gltf_text(bytes), true);
  if (text.empty()) return bytes;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  patched = bytes.substr(0, 8);
  append_word(patched, bytes.size() - chunk + text.size());
  append_word(patched, text.size());
  patched += bytes.substr(16, 4);
  patched += text;
  patched += bytes.substr(header_bytes + chunk);
  return patched;
}

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

// Reads only lines with the keyword: files are large and have one such line or none.
std::vector<fs::path> libraries_of(InputBytes& input, const fs::path& folder, const FileErrors& errors) {
  constexpr std::string_view keyword = "mtllib";
  std::vector<fs::path> files;
  TextChunks chunks(input, errors, obj_syntax);
  for (std::string_view lines; chunks.next(lines);) {
    for (std::size_t at = lines.find(keyword); at != std::string_view::npos;
         at = lines.find(keyword, at + keyword.size())) {
      const std::size_t line = lines.find_last_of("\r\n", at) + 1;  // 0 when there is no line before
      TextCursor cursor(lines.substr(line), errors, obj_syntax);
      if (!cursor.find_word() || cursor.word() != keyword) continue;
      for (const std::string& name : library_names(cursor.rest_of_line(), folder)) files.push_back(folder / name);
    }
  }
  return files;
}

// Returns the files that the elements of an array of a glTF file name, "buffers" or "images".
std::vector<fs::path> gltf_files(const char* array, std::string_view bytes, const fs::path& folder) {
  std::vector<fs::path> files;
  if (is_nested_too_deeply(gltf_text(bytes))) return files;
  const Json json = Json::parse(gltf_text(bytes), nullptr, false);
  if (!json.is_object() || !json.contains(array) || !json[array].is_array()) return files;
  for (const Json& element : json[array]) {
    if (!element.is_object() || !element.contains("uri") || !element["uri"].is_string()) continue;
    fs::path file = folder / file_name_of_uri(element["uri"].get<std::string>());
    if (is_file(file)) files.push_back(std::move(file));
  }
  return files;
}

// Adds the files in `folder` that the ends of these lines name. A name may contain blanks.
void add_named_files(std::string_view lines, const fs::path& folder, std::vector<fs::path>& files) {
  constexpr std::string_view blanks = " \t";
  for (std::size_t begin = 0; begin < lines.size();) {
    const std::size_t end = std::min(lines.find_first_of("\r\n", begin), lines.size());
    std::string_view line = lines.substr(begin, end - begin);
    begin = end + 1;
    line = line.substr(0, line.find_last_not_of(blanks) + 1);
    while (!line.empty()) {
      line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
      if (fs::path file = folder / name_in(folder, without_quotes(line)); is_file(file))
        files.push_back(std::move(file));
      line.remove_prefix(std::min(line.find_first_of(blanks), line.size()));
    }
  }
}

}  // namespace

std::vector<fs::path> files_beside(const fs::path& mesh) {
  const FileErrors errors(mesh);
  const std::optional<MeshFormat> format = find_format(mesh);
  if (format != MeshFormat::obj && format != MeshFormat::gltf) return {};
  InputBytes input(mesh, errors, {});
  if (format == MeshFormat::gltf) return gltf_files("buffers", input.window(input.size()), mesh.parent_path());
  input.skip(utf8_mark_bytes(input.window(1)));
  if (!is_wide_text(input.window(1))) return libraries_of(input, mesh.parent_path(), errors);
  std::string converted;
  InputBytes text(as_utf8(input.window(input.size()), converted, errors));
  return libraries_of(text, mesh.parent_path(), errors);
}

std::vector<fs::path> images_of(const fs::path& mesh) {
  const FileErrors errors(mesh);
  const fs::path folder = mesh.parent_path();
  const std::optional<MeshFormat> format = find_format(mesh);
  std::vector<fs::path> images;
  if (format == MeshFormat::gltf) {
    InputBytes input(mesh, errors, {});
    return gltf_files("images", input.window(input.size()), folder);
  }
  if (format == MeshFormat::ply) {
    InputBytes input(mesh, errors, {});
    const std::string_view beginning = input.window(1);
    const std::size_t end = beginning.find("end_header");
    if (end != std::string_view::npos) add_named_files(beginning.substr(0, end), folder, images);
  }
  if (format != MeshFormat::obj) return images;
  for (const fs::path& library : files_beside(mesh)) {
    std::error_code unknown;
    if (fs::file_size(library, unknown) == 0 || unknown) continue;
    const FileErrors library_errors(library);
    InputBytes input(library, library_errors, {});
    std::string converted;
    add_named_files(as_utf8(input.window(input.size()), converted, library_errors), library.parent_path(), images);
  }
  return images;
}

std::string name_in(const fs::path& folder, std::string_view name) {
  std::string result(name);
  if (name.find('\\') != std::string_view::npos && !is_file(folder / result)) std::ranges::replace(result, '\\', '/');
  return result;
}

std::vector<std::string> library_names(std::string_view line, const fs::path& folder) {
  std::string whole = name_in(folder, without_quotes(line));
  if (is_file(folder / whole)) return {std::move(whole)};
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin < line.size();) {
    const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    std::string name = name_in(folder, without_quotes(line.substr(begin, end - begin)));
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

namespace {

// Reads and parses a file; its bytes are freed on return.
PolygonSoup parse_file(const std::filesystem::path& path, const FileErrors& errors,
                       const std::function<void(double)>& progress) {
  const MeshFormat format = format_of(path, errors);
  InputBytes input(path, errors, progress);
  return parse_mesh(format, input, errors);
}

}  // namespace

PolygonSoup parse_mesh(MeshFormat format, InputBytes& input, const FileErrors& errors) {
  if (format == MeshFormat::ply) return parse_ply<InMemory>(input, errors);
  if (format == MeshFormat::obj) return parse_obj<InMemory>(input, errors);
  const std::string_view bytes = input.window(input.size());
  if (format == MeshFormat::stl) return parse_stl(bytes, errors);  // binary or text
  std::string converted;
  const std::string_view text = as_utf8(bytes, converted, errors);
  switch (format) {
    case MeshFormat::off:
      return parse_off(text, errors);
    case MeshFormat::gltf:
      return parse_gltf(text, errors);
    case MeshFormat::ply:  // parsed by their own functions above
    case MeshFormat::obj:
    case MeshFormat::stl:
      break;
  }
  return {};
}

CleanMesh read_mesh(const std::filesystem::path& path, const std::function<void(double)>& progress, int threads) {
  const FileErrors errors(path);
  PolygonSoup soup = parse_file(path, errors, progress);
  MeshReport report;
  TriangleMesh mesh = take_mesh(soup, report, errors);
  if (progress) progress(1.0);
  return clean(std::move(mesh), report, errors.subject(), threads);
}

}  // namespace occlod
