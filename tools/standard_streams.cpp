#include "standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace occlod::tool {
namespace {

void print_line(const char* kind, std::string_view line) noexcept {
  // The line is printed at once, so that lines of several processes do not mix; fprintf() needs no memory.
  static_cast<void>(std::fprintf(stderr, "occlod: %s: %.*s\n", kind, static_cast<int>(line.size()), line.data()));
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
