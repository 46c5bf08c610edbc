#include "interrupt.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>

namespace occlod::tool {
namespace {

constexpr int signals[] = {SIGINT, SIGTERM};

// The handler reads these. It runs between any two instructions, on any thread.
std::atomic<int> noted_signal = 0;
std::atomic<bool> only_note = false;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);
std::array<char, 128> last_words;  // the handler prints it; ends with a line break
std::size_t last_words_size = 0;

std::string message;  // "build: was cancelled"

int exit_code_of(int number) noexcept { return 128 + number; }

// Calls only what POSIX allows in a handler (signal-safety(7)).
extern "C" void on_signal(int number) {
  noted_signal = number;
  if (only_note) return;
  static_cast<void>(!write(STDERR_FILENO, last_words.data(), last_words_size));
  _exit(exit_code_of(number));
}

}  // namespace

const char* Interrupted::what() const noexcept { return message.c_str(); }

int Interrupted::exit_code() const noexcept { return exit_code_of(noted_signal); }

void handle_interrupts(const std::string& command) {
  message = command + ": was cancelled";
  const bool may_have_bar = isatty(STDERR_FILENO) == 1;
  last_words_size = fmt::format_to_n(last_words.data(), last_words.size(), "{}occlod: error: {}\n",
                                     may_have_bar ? "\r\x1b[K" : "", message)
                        .size;
  for (const int number : signals) {
    struct sigaction before {};
    sigaction(number, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigaction(number, &action, nullptr);
  }
}

void note_interrupts() {
  only_note = true;
  if (noted_signal != 0) throw Interrupted();
}

}  // namespace occlod::tool
