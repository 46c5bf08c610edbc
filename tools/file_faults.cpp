#include "file_faults.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdint>

namespace occlod::tool {
namespace {

// The handler calls only what signal-safety(7) allows: nothing allocates or throws.

std::array<char, 64> name_of_program;
std::size_t name_size = 0;
std::atomic_flag telling;  // a thread is about to say what failed and to end the process

// Reads the lines of a file; the ends of long ones are dropped.
class Lines {
 public:
  explicit Lines(const char* path) : fd_(open(path, O_RDONLY | O_CLOEXEC)) {}

  // Returns the next line, valid until the next call; empty at the end.
  std::string_view next() {
    std::size_t size = 0;
    for (char c = 0; read_char(c) && c != '\n';)
      if (size < line_.size()) line_[size++] = c;
    return {line_.data(), size};
  }

 private:
  bool read_char(char& c) {
    if (at_ == size_) {
      const ssize_t got = fd_ < 0 ? 0 : read(fd_, block_.data(), block_.size());
      if (got <= 0) return false;
      at_ = 0;
      size_ = static_cast<std::size_t>(got);
    }
    c = block_[at_++];
    return true;
  }

  int fd_;  // left open: the process ends
  std::array<char, 1024> block_{}, line_{};
  std::size_t at_ = 0, size_ = 0;
};

// Returns the file of the mapping that holds the address: "7f00-7f10 r--s 00000000 08:01 42      /folder/file",
// proc(5). Empty if there is no mapping, or it is not a file's.
std::string_view mapped_file_at(Lines& lines, std::uintptr_t address) {
  for (std::string_view line = lines.next(); !line.empty(); line = lines.next()) {
    std::uintptr_t begin = 0, end = 0;
    const char* const line_end = line.data() + line.size();
    const auto dash = std::from_chars(line.data(), line_end, begin, 16);
    if (dash.ptr == line_end || *dash.ptr != '-') continue;
    std::from_chars(dash.ptr + 1, line_end, end, 16);
    if (address < begin || address >= end) continue;
    const std::size_t path = line.find('/');
    return path == std::string_view::npos ? std::string_view() : line.substr(path);
  }
  return {};
}

void say(std::string_view text) { static_cast<void>(!write(STDERR_FILENO, text.data(), text.size())); }

extern "C" void on_bus_error(int number, siginfo_t* info, void* /*context*/) {
  Lines maps("/proc/self/maps");
  const std::string_view file = mapped_file_at(maps, reinterpret_cast<std::uintptr_t>(info->si_addr));
  if (file.empty()) {  // the default applies when the handler returns to the same instruction
    std::signal(number, SIG_DFL);
    return;
  }
  while (telling.test_and_set()) pause();  // the file is gone for the other threads too: one of them tells
  say({name_of_program.data(), name_size});
  say(": error: ");
  for (const char c : file) say(static_cast<unsigned char>(c) < ' ' ? std::string_view("?") : std::string_view(&c, 1));
  say(": was cut short while it was read, or its disk failed; write it again, and leave it alone while it is used\n");
  _exit(1);
}

}  // namespace

void handle_file_faults(std::string_view program) {
  name_size = std::min(program.size(), name_of_program.size());
  std::copy_n(program.begin(), name_size, name_of_program.begin());
  struct sigaction action {};
  action.sa_sigaction = on_bus_error;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGBUS, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace occlod::tool
