// Walks through the words of a text, line by line, and reads numbers without regard to the locale.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "base/file_input.h"

namespace occlod {

// Lines end with LF, CR LF or CR. Words are separated by blanks. Views and errors outlive the cursor.
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

  // Skips blanks; true where no word is left on this line.
  [[nodiscard]] bool at_line_end();
  // Goes to the next line that has a word; false at the end of the text. The current line counts.
  [[nodiscard]] bool find_word();
  void skip_line();

  // The next word of this line, empty where there is none.
  [[nodiscard]] std::string_view word();
  // What is left of this line, without the blanks around it: a name that may have blanks and '#' within. Is not joined
  // with the next line.
  [[nodiscard]] std::string_view rest_of_line();
  // The next word of this line as a number; `what` names it in errors, e.g. "x of a vertex".
  [[nodiscard]] double number(const char* what);
  [[nodiscard]] std::int64_t integer(const char* what);

  [[noreturn]] void fail(std::string problem, std::string remedy) const {
    errors_->fail_at_line(line_, std::move(problem), std::move(remedy));
  }

 private:
  template <class Number>
  Number parse(const char* what, const char* kind);
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

// Of OBJ files.
inline constexpr TextCursor::Syntax obj_syntax{.hash_comments = true, .backslash_continues = true};

}  // namespace occlod
