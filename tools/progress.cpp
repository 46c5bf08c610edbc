#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>

namespace occlod::tool {

Progress::Progress() : is_terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (!line_.empty()) fmt::print(stderr, "\r\x1b[K");
}

void Progress::show(const std::string& what, double done) {
  if (!is_terminal_) return;
  constexpr int width = 40;
  const auto filled = static_cast<std::size_t>(width * std::clamp(done, 0.0, 1.0));
  std::string line = fmt::format("[{:-<{}}] {:3.0f} % {}", std::string(filled, '#'), width, 100.0 * done, what);
  if (line == line_) return;
  fmt::print(stderr, "\r\x1b[K{}", line);
  std::fflush(stderr);
  line_ = std::move(line);
}

}  // namespace occlod::tool
