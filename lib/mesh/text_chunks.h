// A text read in runs of whole lines, so that it need not lie in memory.
#pragma once

#include <cstdint>
#include <string_view>

#include "base/file_input.h"
#include "base/text_cursor.h"

namespace occlod {

class TextChunks {
 public:
  // The UTF-8 text from where `input` is, which outlives this as `errors` does.
  TextChunks(InputBytes& input, const FileErrors& errors, TextCursor::Syntax syntax)
      : input_(input), errors_(errors), syntax_(syntax) {}

  // Puts the cursor, which is at the end of the lines before, on the next ones; what it gave out before is void. False
  // at the end of the text. No line is cut, also one that a backslash continues.
  [[nodiscard]] bool next(TextCursor& cursor);
  // The same lines as a text, which is valid until the next call.
  [[nodiscard]] bool next(std::string_view& lines);

 private:
  InputBytes& input_;
  const FileErrors& errors_;
  TextCursor::Syntax syntax_;
  std::size_t taken_ = 0;  // of the window, by the cursor
};

}  // namespace occlod
