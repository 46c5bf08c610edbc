// Text in the encodings that editors and exporters write.
#pragma once

#include <string>
#include <string_view>

#include "base/file_input.h"

namespace occlod {

// A text as UTF-8 without a byte order mark: a view of `bytes` or, where they are UTF-16 of either byte order, of
// `converted`, which holds the text afterwards. UTF-16 is recognised by its byte order mark or, without one, by two
// ASCII characters at the beginning. Throws Error for UTF-16 that ends within a character and for UTF-32.
[[nodiscard]] std::string_view as_utf8(std::string_view bytes, std::string& converted, const FileErrors& errors);

// Whether the text that begins like this is UTF-16 or UTF-32, which as_utf8() has to see as a whole.
[[nodiscard]] bool is_wide_text(std::string_view beginning);

// Of the byte order mark that a text in UTF-8 begins with, or 0.
[[nodiscard]] std::size_t utf8_mark_bytes(std::string_view beginning);

}  // namespace occlod
