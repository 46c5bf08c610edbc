#include "mesh/data_uri.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace occlod {
namespace {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

// Returns the six bits of a digit, or -1.
int digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-' || c == ' ') return 62;
  return c == '/' || c == '_' ? 63 : -1;
}

}  // namespace

std::optional<DataUri> parse_data_uri(std::string_view uri) {
  constexpr std::string_view scheme = "data:";
  const std::size_t comma = uri.find(',');
  if (lower_case(uri.substr(0, scheme.size())) != scheme || comma == std::string_view::npos) return std::nullopt;
  const std::string header = lower_case(uri.substr(scheme.size(), comma - scheme.size()));
  return DataUri{header.substr(0, header.find(';')), header.ends_with(";base64"), uri.substr(comma + 1)};
}

std::optional<std::vector<std::uint8_t>> decode_base64(std::string_view text) {
  while (text.ends_with('=')) text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int count = 0;  // of bits that have not become bytes
  for (const char c : text) {
    const int value = digit(c);
    if (value < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count));
  }
  return bytes;
}

}  // namespace occlod
