#include "base/text.h"

#include <fmt/format.h>
#include <locale.h>
#include <stdlib.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#if __has_include(<xlocale.h>)
#include <xlocale.h>
#endif

namespace occlod {
namespace {

constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr char lower_case(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

const char* skip_digits(const char* at, const char* last) { return std::find_if_not(at, last, is_digit); }

// Returns the end of a run of digits with at most one point, or `first` when there is no digit.
const char* end_of_digits(const char* first, const char* last) {
  const char* const point = skip_digits(first, last);
  if (point == last || *point != '.') return point;
  const char* const end = skip_digits(point + 1, last);
  return end - first > 1 ? end : first;
}

// Returns the end of an exponent, or `first` when there is none.
const char* end_of_exponent(const char* first, const char* last) {
  if (first == last || lower_case(*first) != 'e') return first;
  const char* const digits = last - first > 1 && (first[1] == '-' || first[1] == '+') ? first + 2 : first + 1;
  const char* const end = skip_digits(digits, last);
  return end == digits ? first : end;
}

// Returns the end of "infinity", "inf" or "nan" in any case, or `first` when there is none.
const char* end_of_name(const char* first, const char* last) {
  for (const std::string_view name : {"infinity", "inf", "nan"}) {
    const std::string_view text(first, std::min(name.size(), static_cast<std::size_t>(last - first)));
    if (std::ranges::equal(text, name, {}, lower_case)) return first + name.size();
  }
  return first;
}

double to_double(const std::string& number) {
  static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
  return strtod_l(number.c_str(), nullptr, plain);
}

}  // namespace

std::from_chars_result parse_double_portably(const char* first, const char* last, double& value) {
  const char* const digits = first != last && *first == '-' ? first + 1 : first;
  const char* const mantissa = end_of_digits(digits, last);
  const bool is_finite = mantissa != digits;
  const char* const end = is_finite ? end_of_exponent(mantissa, last) : end_of_name(digits, last);
  if (end == digits) return {first, std::errc::invalid_argument};
  const double parsed = to_double({first, end});
  const bool is_zero = std::none_of(digits, mantissa, [](char c) { return c >= '1' && c <= '9'; });
  if (is_finite && (std::isinf(parsed) || (parsed == 0.0 && !is_zero))) return {end, std::errc::result_out_of_range};
  value = parsed;
  return {end, {}};
}

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool is_break(char c) { return c == '\n' || c == '\r'; }

std::from_chars_result parse_number(const char* first, const char* last, double& value) {
  return parse_double(first, last, value);
}
std::from_chars_result parse_number(const char* first, const char* last, std::int64_t& value) {
  return std::from_chars(first, last, value);
}

}  // namespace

TextCursor::TextCursor(std::string_view text, const FileErrors& errors, Syntax syntax, std::uint64_t first_line)
    : begin_(text.data()),
      at_(begin_),
      end_(begin_ + text.size()),
      line_(first_line),
      errors_(&errors),
      syntax_(syntax) {}

bool TextCursor::is_at_line_end() {
  while (at_ != end_ && (is_blank(*at_) || skip_continuation())) ++at_;
  return at_ == end_ || is_break(*at_) || (syntax_.hash_comments && *at_ == '#');
}

bool TextCursor::is_continuation(const char* at) const {
  return syntax_.backslash_continues && *at == '\\' && end_ - at > 1 && is_break(at[1]);
}

bool TextCursor::ends_word(const char* at) const {
  return at == end_ || is_blank(*at) || is_break(*at) || is_continuation(at);
}

// Leaves the cursor on the last byte of the line break.
bool TextCursor::skip_continuation() {
  if (!is_continuation(at_)) return false;
  ++at_;
  if (*at_ == '\r' && end_ - at_ > 1 && at_[1] == '\n') ++at_;
  ++line_;
  return true;
}

bool TextCursor::find_word() {
  while (at_line_end()) {
    if (at_ == end_) return false;
    skip_line();
  }
  return true;
}

void TextCursor::skip_line() {
  if (at_ != end_ && *at_ == '\n') return skip_line_break();
  const bool comment = at_line_end();
  while (at_ != end_ && !is_break(*at_)) {
    if (!comment) skip_continuation();
    ++at_;
  }
  skip_line_break();
}

void TextCursor::skip_line_break() {
  if (at_ == end_) return;
  if (*at_ == '\r' && end_ - at_ > 1 && at_[1] == '\n') ++at_;
  ++at_;
  ++line_;
}

std::string_view TextCursor::word() {
  if (at_line_end()) return {};
  const char* const first = at_;
  while (at_ != end_ && (is_plain(*at_) || !ends_word(at_))) ++at_;
  return {first, static_cast<std::size_t>(at_ - first)};
}

std::string_view TextCursor::rest_of_line() {
  if (at_line_end()) return {};
  const char* const first = at_;
  while (at_ != end_ && !is_break(*at_) && !is_continuation(at_)) ++at_;
  const char* last = at_;
  while (is_blank(last[-1])) --last;
  return {first, static_cast<std::size_t>(last - first)};
}

template <class Number>
Number TextCursor::parse(const char* what, const char* kind) {
  if (at_line_end()) fail(fmt::format("{} is missing", what), "complete the line or export the mesh again");
  const char* const first = at_;
  Number value{};
  const std::from_chars_result result = parse_number(*first == '+' ? first + 1 : first, end_, value);
  const bool whole = ends_word(result.ptr);
  if (result.ec != std::errc{} || !whole || (*first == '+' && end_ - first > 1 && first[1] == '-')) {
    const bool too_large = result.ec == std::errc::result_out_of_range;
    fail(fmt::format("{} is {}, which is {} {}", what, in_quotes(word()), too_large ? "out of range for" : "not", kind),
         "correct the line or export the mesh again");
  }
  at_ = result.ptr;
  return value;
}

double TextCursor::number(const char* what) { return parse<double>(what, "a number"); }
std::int64_t TextCursor::integer(const char* what) { return parse<std::int64_t>(what, "a whole number"); }

std::size_t TextCursor::words_left() const {
  std::size_t words = 0;
  for (TextCursor ahead = *this; !ahead.at_line_end(); ++words) static_cast<void>(ahead.word());
  return words;
}

namespace {

constexpr std::string_view utf8_mark = "\xef\xbb\xbf";
constexpr char32_t byte_order_mark = 0xfeff;
constexpr char32_t replacement = 0xfffd;  // stands for an unpaired surrogate
constexpr char32_t first_surrogate = 0xd800, first_low_surrogate = 0xdc00, last_surrogate = 0xdfff;

std::uint16_t unit_at(std::string_view bytes, std::size_t at, std::endian order) {
  return load<std::uint16_t>(bytes.data() + at, order);
}

bool is_ascii(std::uint16_t unit) { return unit > 0 && unit < 0x80; }

// Returns the byte order of UTF-16 text, or nothing when the bytes are not UTF-16.
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

// Converts UTF-16 to UTF-8. `units` has an even number of bytes.
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

namespace {

constexpr char32_t first_byte = 0x10ff00;  // stands for the byte 0

// Returns the number of bytes of the UTF-8 character at the beginning, and the character; 0 bytes for anything else.
std::pair<std::size_t, char32_t> first_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  const std::size_t size = lead < 0x80 ? 1 : lead < 0xc2 ? 0 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : lead < 0xf5 ? 4 : 0;
  if (size == 0 || text.size() < size) return {0, 0};
  char32_t c = size == 1 ? lead : lead & (0x7fU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return {0, 0};
    c = c << 6U | (byte(i) & 0x3fU);
  }
  constexpr std::array<char32_t, 5> least = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_character = c >= least[size] && c <= 0x10ffff && (c < first_surrogate || c > last_surrogate);
  return {is_character ? size : 0, c};
}

}  // namespace

bool is_utf8(std::string_view bytes) noexcept {
  while (!bytes.empty()) {
    const std::size_t size = first_character(bytes).first;
    if (size == 0) return false;
    bytes.remove_prefix(size);
  }
  return true;
}

std::string from_latin1(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) append(static_cast<unsigned char>(c), text);
  return text;
}

std::string utf8_of_bytes(std::string_view bytes) {
  std::string text;
  while (!bytes.empty()) {
    const auto [size, c] = first_character(bytes);
    const bool is_kept = size > 0 && c < first_byte;
    if (is_kept)
      text += bytes.substr(0, size);
    else
      append(first_byte + static_cast<unsigned char>(bytes[0]), text);
    bytes.remove_prefix(is_kept ? size : 1);
  }
  return text;
}

std::string bytes_of_utf8(std::string_view text) {
  std::string bytes;
  while (!text.empty()) {
    const auto [size, c] = first_character(text);
    const std::size_t taken = std::max<std::size_t>(size, 1);
    if (size > 0 && c >= first_byte)
      bytes += static_cast<char>(c - first_byte);
    else
      bytes += text.substr(0, taken);
    text.remove_prefix(taken);
  }
  return bytes;
}

namespace {

// Returns the size of the text up to and including the last line feed that no backslash continues; 0 where there is
// none.
std::size_t whole_lines(std::string_view text) {
  for (std::size_t end = text.rfind('\n'); end != std::string_view::npos && end > 0; end = text.rfind('\n', end - 1)) {
    const char before = text[end - 1] == '\r' && end > 1 ? text[end - 2] : text[end - 1];
    if (before != '\\') return end + 1;
  }
  return 0;
}

}  // namespace

bool TextChunks::next(TextCursor& cursor) {
  std::string_view lines;
  if (!next(lines)) return false;
  cursor = TextCursor(lines, errors_, syntax_, cursor.line());
  return true;
}

bool TextChunks::next(std::string_view& lines) {
  input_.skip(taken_);
  std::string_view text = input_.window(1);
  taken_ = 0;
  while (taken_ == 0 && !text.empty()) {
    const bool is_last = input_.offset() + text.size() == input_.size();
    taken_ = is_last ? text.size() : whole_lines(text);
    if (taken_ == 0) text = input_.window(2 * text.size());
  }
  lines = text.substr(0, taken_);
  return taken_ > 0;
}

}  // namespace occlod
