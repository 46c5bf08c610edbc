// Reads text: numbers, words and lines, in the encodings that editors and exporters write.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <version>

#include "base/file_input.h"

namespace occlod {

// Returns 0 to 15, or -1 for a character that is no hexadecimal digit.
[[nodiscard]] constexpr int hex_digit(char c) noexcept {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

// True when the texts differ at most in the case of ASCII letters.
[[nodiscard]] inline bool equal_ignoring_case(std::string_view a, std::string_view b) noexcept {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

// Reads the sizeof(Number) bytes at `at` in the given byte order. `at` need not be aligned.
template <class Number>
[[nodiscard]] Number load(const char* at, std::endian order) noexcept {
  std::array<char, sizeof(Number)> bytes;
  std::memcpy(bytes.data(), at, sizeof(Number));
  if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<Number>(bytes);
}

// parse_double() does what std::from_chars does for decimal fractions, which libc++ before 20 lacks.

// Does the same as std::from_chars, with strtod.
[[nodiscard]] std::from_chars_result parse_double_portably(const char* first, const char* last, double& value);

[[nodiscard]] inline std::from_chars_result parse_double(const char* first, const char* last, double& value) {
#if defined(__cpp_lib_to_chars)
  return std::from_chars(first, last, value);
#else
  return parse_double_portably(first, last, value);
#endif
}

// Walks through the words of a text, line by line, and reads numbers independently of the locale. Lines end with LF, CR
// LF or CR; blanks separate words. The text and the errors outlive the cursor.
class TextCursor {
 public:
  struct Syntax {
    bool hash_comments = false;        // a word that starts with '#' begins a comment
    bool backslash_continues = false;  // a backslash at the end of a line joins it with the next
  };

  TextCursor(std::string_view text, const FileErrors& errors, Syntax syntax, std::uint64_t first_line = 1);

  [[nodiscard]] std::uint64_t line() const noexcept { return line_; }
  [[nodiscard]] std::size_t bytes_left() const noexcept { return static_cast<std::size_t>(end_ - at_); }
  [[nodiscard]] std::size_t offset() const noexcept { return static_cast<std::size_t>(at_ - begin_); }
  [[nodiscard]] const FileErrors& errors() const noexcept { return *errors_; }

  // Skips blanks; returns true where no word is left on this line.
  [[nodiscard]] bool at_line_end() {
    if (at_ != end_ && *at_ == ' ') ++at_;
    if (at_ != end_ && is_plain(*at_) && *at_ != '#') return false;
    return is_at_line_end();
  }
  // Moves to the next line that has a word, the current line included; returns false at the end of the text.
  [[nodiscard]] bool find_word();
  void skip_line();

  // Returns the next word of this line, empty where there is none.
  [[nodiscard]] std::string_view word();
  // Returns the rest of this line without the blanks around it, for a name that may contain blanks and '#'. The line is
  // not joined with the next one.
  [[nodiscard]] std::string_view rest_of_line();
  // Reads the next word of this line as a number; `what` names it in errors, e.g. "x of a vertex".
  [[nodiscard]] double number(const char* what);
  [[nodiscard]] std::int64_t integer(const char* what);
  // Returns the number of words from here to the end of this line.
  [[nodiscard]] std::size_t words_left() const;

  [[noreturn]] void fail(std::string problem, std::string remedy) const {
    errors_->fail_at_line(line_, std::move(problem), std::move(remedy));
  }

 private:
  template <class Number>
  Number parse(const char* what, const char* kind);
  // True for most characters of words: none that may be a blank, a line break or a continuation.
  static bool is_plain(char c) { return static_cast<unsigned char>(c) > ' ' && c != '\\'; }
  [[nodiscard]] bool is_at_line_end();
  [[nodiscard]] bool is_continuation(const char* at) const;
  [[nodiscard]] bool ends_word(const char* at) const;
  bool skip_continuation();
  void skip_line_break();

  const char* begin_;
  const char* at_;
  const char* end_;
  std::uint64_t line_;
  const FileErrors* errors_;
  Syntax syntax_;
};

// The syntax of OBJ files.
inline constexpr TextCursor::Syntax obj_syntax{.hash_comments = true, .backslash_continues = true};

// Returns a text as UTF-8 without a byte order mark: a view of `bytes` or, where they are UTF-16 of either byte order,
// of `converted`, which then holds the text. UTF-16 is recognised by its byte order mark or, without one, by two ASCII
// characters at the beginning. Throws Error for UTF-16 that ends within a character and for UTF-32.
[[nodiscard]] std::string_view as_utf8(std::string_view bytes, std::string& converted, const FileErrors& errors);

// True when a text with this beginning is UTF-16 or UTF-32, which as_utf8() must see as a whole.
[[nodiscard]] bool is_wide_text(std::string_view beginning);

// Returns the size in bytes of the byte order mark at the beginning of a UTF-8 text, or 0.
[[nodiscard]] std::size_t utf8_mark_bytes(std::string_view beginning);

// True when the bytes are UTF-8, without surrogates and overlong forms.
[[nodiscard]] bool is_utf8(std::string_view bytes) noexcept;
// Converts Latin-1 to UTF-8.
[[nodiscard]] std::string from_latin1(std::string_view bytes);
// Return a text of any bytes as UTF-8, and back: bytes that are not UTF-8 become U+10FF00 to U+10FFFF, and so do those
// of such characters. Other text stays as it is.
[[nodiscard]] std::string utf8_of_bytes(std::string_view bytes);
[[nodiscard]] std::string bytes_of_utf8(std::string_view text);

// A text read in runs of whole lines, so that it need not be in memory as a whole.
class TextChunks {
 public:
  // Reads UTF-8 text from the current position of `input`. `input` and `errors` must outlive this object.
  TextChunks(InputBytes& input, const FileErrors& errors, TextCursor::Syntax syntax)
      : input_(input), errors_(errors), syntax_(syntax) {}

  // Puts the cursor, which must be at the end of the previous lines, on the next run of lines; views that it returned
  // before become invalid. Returns false at the end of the text. No line is cut, and neither is one that a backslash
  // continues.
  [[nodiscard]] bool next(TextCursor& cursor);
  // Returns the next run of lines as a text that is valid until the next call; returns false at the end of the text.
  [[nodiscard]] bool next(std::string_view& lines);

 private:
  InputBytes& input_;
  const FileErrors& errors_;
  TextCursor::Syntax syntax_;
  std::size_t taken_ = 0;  // bytes of the window that were given to the cursor
};

}  // namespace occlod
