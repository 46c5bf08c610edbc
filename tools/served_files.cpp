#include "served_files.h"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "base/text.h"

namespace occlod::tool {
namespace {

namespace fs = std::filesystem;

std::optional<std::uint64_t> number_of(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

std::optional<std::string> path_of_target(std::string_view target) {
  target = target.substr(0, target.find('?'));
  if (target.empty() || target.front() != '/') return std::nullopt;
  std::string path;
  for (std::size_t i = 0; i < target.size(); ++i) {
    char c = target[i];
    if (c == '%') {
      if (i + 2 >= target.size()) return std::nullopt;
      const int high = hex_digit(target[i + 1]), low = hex_digit(target[i + 2]);
      if (high < 0 || low < 0) return std::nullopt;
      c = static_cast<char>(16 * high + low);
      i += 2;
    }
    if (c == '\0' || c == '\\') return std::nullopt;
    path += c;
  }
  return path;
}

std::optional<fs::path> file_in(const fs::path& folder, const std::string& name) {
  if (name.empty() || name.front() == '/') return std::nullopt;
  std::error_code error;
  const fs::path whole = fs::canonical(folder, error);
  if (error) return std::nullopt;
  fs::path file = fs::canonical(whole / name, error);
  if (error || !fs::is_regular_file(file, error)) return std::nullopt;
  if (std::mismatch(whole.begin(), whole.end(), file.begin(), file.end()).first != whole.end()) return std::nullopt;
  return file;
}

std::optional<ByteRange> range_of(std::string_view header, std::uint64_t size) {
  constexpr std::string_view unit = "bytes=";
  const ByteRange whole{0, size};
  if (!header.starts_with(unit) || header.find(',') != std::string_view::npos) return whole;
  header.remove_prefix(unit.size());
  const std::size_t dash = header.find('-');
  if (dash == std::string_view::npos) return whole;
  const std::string_view first_text = header.substr(0, dash), last_text = header.substr(dash + 1);
  const std::optional<std::uint64_t> first = number_of(first_text), last = number_of(last_text);
  if (first_text.empty()) {  // the last bytes
    if (!last) return whole;
    if (*last == 0 || size == 0) return std::nullopt;
    const std::uint64_t count = std::min(*last, size);
    return ByteRange{size - count, count};
  }
  if (!first || (!last && !last_text.empty()) || (last && *last < *first)) return whole;
  if (*first >= size) return std::nullopt;
  const std::uint64_t end = last ? std::min(*last, size - 1) + 1 : size;
  return ByteRange{*first, end - *first};
}

const char* mime_type(const fs::path& file) {
  static constexpr std::pair<std::string_view, const char*> types[] = {
      {".css", "text/css"},          {".glb", "model/gltf-binary"}, {".html", "text/html; charset=utf-8"},
      {".jpeg", "image/jpeg"},       {".jpg", "image/jpeg"},        {".js", "text/javascript"},
      {".json", "application/json"}, {".ktx2", "image/ktx2"},       {".mjs", "text/javascript"},
      {".png", "image/png"},         {".svg", "image/svg+xml"},     {".wasm", "application/wasm"},
      {".webp", "image/webp"},       {".xml", "application/xml"},
  };
  const std::string extension = file.extension().string();
  for (const auto& [ending, type] : types)
    if (extension == ending) return type;
  return "application/octet-stream";
}

}  // namespace occlod::tool
