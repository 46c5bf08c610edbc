#include "mesh/text_chunks.h"

namespace occlod {
namespace {

// The bytes up to the last line feed that ends a line; 0 where there is none.
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
