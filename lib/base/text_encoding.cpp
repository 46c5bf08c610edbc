#include "base/text_encoding.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <optional>

#include "base/byte_order.h"

namespace occlod {
namespace {

constexpr std::string_view utf8_mark = "\xef\xbb\xbf";
constexpr char32_t byte_order_mark = 0xfeff;
constexpr char32_t replacement = 0xfffd;  // for half of a surrogate pair
constexpr char32_t first_surrogate = 0xd800, first_low_surrogate = 0xdc00, last_surrogate = 0xdfff;

std::uint16_t unit_at(std::string_view bytes, std::size_t at, std::endian order) {
  return load<std::uint16_t>(bytes.data() + at, order);
}

bool is_ascii(std::uint16_t unit) { return unit > 0 && unit < 0x80; }

// The byte order of UTF-16, none where the bytes are not UTF-16.
std::optional<std::endian> utf16_order(std::string_view bytes) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    if (bytes.size() >= 2 && unit_at(bytes, 0, order) == byte_order_mark) return order;
    if (bytes.size() >= 4 && is_ascii(unit_at(bytes, 0, order)) && is_ascii(unit_at(bytes, 2, order))) return order;
  }
  return std::nullopt;
}

bool is_utf32(std::string_view bytes) {
  using namespace std::string_view_literals;
  return bytes.starts_with("\xff\xfe\0\0"sv) || bytes.starts_with("\0\0\xfe\xff"sv);
}

void append(char32_t c, std::string& text) {
  const auto trail = [&](int shift) { text += static_cast<char>(0x80 | ((c >> shift) & 0x3f)); };
  if (c < 0x80) {
    text += static_cast<char>(c);
  } else if (c < 0x800) {
    text += static_cast<char>(0xc0 | (c >> 6));
    trail(0);
  } else if (c < 0x10000) {
    text += static_cast<char>(0xe0 | (c >> 12));
    trail(6);
    trail(0);
  } else {
    text += static_cast<char>(0xf0 | (c >> 18));
    trail(12);
    trail(6);
    trail(0);
  }
}

// `units` has an even number of bytes.
std::string from_utf16(std::string_view units, std::endian order) {
  std::string text;
  text.reserve(units.size() / 2);
  for (std::size_t at = 0; at < units.size(); at += 2) {
    char32_t c = unit_at(units, at, order);
    if (c >= first_surrogate && c <= last_surrogate) {
      const char32_t low = at + 2 < units.size() ? unit_at(units, at + 2, order) : 0;
      const bool is_pair = c < first_low_surrogate && low >= first_low_surrogate && low <= last_surrogate;
      c = is_pair ? 0x10000 + ((c - first_surrogate) << 10) + (low - first_low_surrogate) : replacement;
      if (is_pair) at += 2;
    }
    append(c, text);
  }
  return text;
}

}  // namespace

bool is_wide_text(std::string_view beginning) { return is_utf32(beginning) || utf16_order(beginning).has_value(); }

std::size_t utf8_mark_bytes(std::string_view beginning) {
  return beginning.starts_with(utf8_mark) ? utf8_mark.size() : 0;
}

std::string_view as_utf8(std::string_view bytes, std::string& converted, const FileErrors& errors) {
  if (const std::size_t mark = utf8_mark_bytes(bytes); mark > 0) return bytes.substr(mark);
  if (is_utf32(bytes)) errors.fail("", "is UTF-32 text", "save it as UTF-8, e.g. with 'iconv -f UTF-32 -t UTF-8'");
  const std::optional<std::endian> order = utf16_order(bytes);
  if (!order) return bytes;
  if (bytes.size() % 2 != 0) {
    errors.fail(fmt::format("byte {}", bytes.size() - 1), "is UTF-16 text that ends within a character",
                "the file is cut short; export the mesh again, as UTF-8");
  }
  converted = from_utf16(unit_at(bytes, 0, *order) == byte_order_mark ? bytes.substr(2) : bytes, *order);
  return converted;
}

}  // namespace occlod
