#include "base/text_cursor.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <system_error>

#include "base/parse_double.h"

namespace occlod {
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

bool TextCursor::at_line_end() {
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
  while (!ends_word(at_)) ++at_;
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

}  // namespace occlod
