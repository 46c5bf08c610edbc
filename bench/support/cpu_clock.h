#pragma once

#include <ctime>

namespace occlod::bench {

// Time that this thread has run, ms: what others do on the machine meanwhile does not count.
[[nodiscard]] inline double thread_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace occlod::bench
