#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "standard_streams.h"

namespace occlod::tool {
namespace {

constexpr double bar_interval_ms = 100.0;
constexpr double line_interval_ms = 1000.0;
constexpr double min_ms = 1000.0;  // rates over less time are noise

const std::string wipe_line = "\r\x1b[K";

std::string bar(double done) {
  constexpr int width = 40;
  return fmt::format("[{:-<{}}] {:3.0f} % ", std::string(static_cast<std::size_t>(width * done), '#'), width,
                     100.0 * done);
}

std::string rate_and_rest(double done, double elapsed_ms, std::size_t triangles) {
  if (done <= 0.0 || elapsed_ms < min_ms) return "";
  std::string text;
  if (triangles > 0) {
    text += fmt::format(", {:.2f} M triangles/s", 1e-3 * done * static_cast<double>(triangles) / elapsed_ms);
  }
  const auto seconds = static_cast<long>(std::ceil(1e-3 * elapsed_ms * (1.0 - done) / done));
  return text + (seconds < 120 ? fmt::format(", {} s left", seconds) : fmt::format(", {} min left", seconds / 60));
}

}  // namespace

Progress::Progress(ShowProgress when)
    : is_terminal_(isatty(STDERR_FILENO) == 1),
      is_shown_(when == ShowProgress::always || (when == ShowProgress::automatic && is_terminal_)) {}

void Progress::clear() {
  if (has_bar_) write_to_standard_error(wipe_line);
  has_bar_ = false;
}

bool Progress::is_due(bool new_stage) const {
  return new_stage || !since_line_ ||
         since_line_->milliseconds() >= (is_terminal_ ? bar_interval_ms : line_interval_ms);
}

void Progress::show(const std::string& what, std::optional<double> done, std::size_t triangles) {
  const bool new_stage = what != what_;
  if (new_stage) {
    what_ = what;
    stage_ = {};
  }
  if (!is_shown_ || !is_due(new_stage)) return;
  since_line_.emplace();
  std::string line = printable(what);
  if (done) {
    const double share = std::clamp(*done, 0.0, 1.0);
    line = bar(share) + line + rate_and_rest(share, stage_.milliseconds(), triangles);
  }
  has_bar_ = is_terminal_;
  write_to_standard_error(is_terminal_ ? wipe_line + line : line + "\n");
}

}  // namespace occlod::tool
