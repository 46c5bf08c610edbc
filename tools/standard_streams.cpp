#include "standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>

namespace occlod::tool {
namespace {

// Calls put(text) for the parts of a text with its control characters escaped: those of ASCII and, as UTF-8, U+0080 to
// U+009F.
template <class Put>
void put_printable(std::string_view text, const Put& put) {
  while (!text.empty()) {
    const auto is_control = [&](std::size_t i) {
      const auto c = static_cast<unsigned char>(text[i]);
      const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0U;
      return c < ' ' || c == 0x7f || (c == 0xc2 && next >= 0x80 && next < 0xa0);
    };
    std::size_t plain = 0;
    while (plain < text.size() && !is_control(plain)) ++plain;
    put(text.substr(0, plain));
    text.remove_prefix(plain);
    if (text.empty()) return;
    constexpr std::string_view digits = "0123456789abcdef";
    const bool has_two_bytes = text[0] == '\xc2';
    const auto code = static_cast<unsigned char>(text[has_two_bytes ? 1 : 0]);
    const std::array<char, 4> escaped = {'\\', 'x', digits[code >> 4U], digits[code & 15U]};
    put(code == '\n' ? std::string_view("\\n") : std::string_view(escaped.data(), escaped.size()));
    text.remove_prefix(has_two_bytes ? 2 : 1);
  }
}

// Prints the line at once, so that lines of several processes do not mix, and without memory. The rest of a line that
// is longer than any that the library makes of names is left out.
void print_line(std::string_view kind, std::string_view line) noexcept {
  std::array<char, 32'768> buffer;
  std::size_t size = 0;
  const auto put = [&](std::string_view text) {
    text = text.substr(0, buffer.size() - 1 - size);
    std::ranges::copy(text, buffer.data() + size);
    size += text.size();
  };
  put("occlod: ");
  put(kind);
  put(": ");
  put_printable(line, put);
  buffer[size++] = '\n';
  write_to_standard_error({buffer.data(), size});
}

}  // namespace

void reserve_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
    // Opened for the wrong direction, it fails in use as before. open() returns the lowest free number, which is this
    // one.
    static_cast<void>(open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

std::string printable(std::string_view text) {
  std::string result;
  put_printable(text, [&](std::string_view part) { result += part; });
  return result;
}

void write_to_standard_error(std::string_view text) noexcept {
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
  static_cast<void>(std::fflush(stderr));
}

void print_error(std::string_view line) noexcept { print_line("error", line); }
void print_note(std::string_view line) noexcept { print_line("note", line); }

void flush_standard_output() {
  if (std::fflush(stdout) != 0) throw output_error({errno, std::generic_category()});
}

Error output_error(std::error_code reason) {
  return Error({"standard output", "", reason.message(), "check where it goes and the space there"});
}

}  // namespace occlod::tool
