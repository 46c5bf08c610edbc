#include "hlod/draw/virtual_clock.h"

#include <algorithm>

namespace occlod::hlod {

double VirtualClock::command(double submit_ns, double command_ns) {
  cpu_ns_ += submit_ns;
  const double start = std::max(cpu_ns_, gpu_ns_);
  if (commands_ > 0) starve_ns_ += start - gpu_ns_;
  gpu_ns_ = start + command_ns;
  busy_ns_ += command_ns;
  ++commands_;
  return gpu_ns_;
}

void VirtualClock::wait_until(double ns) {
  if (ns <= cpu_ns_) return;
  stall_ns_ += ns - cpu_ns_;
  cpu_ns_ = ns;
}

FrameTimes VirtualClock::times() const noexcept {
  constexpr double ms = 1e-6;
  return {std::max(cpu_ns_, gpu_ns_) * ms, cpu_ns_ * ms, busy_ns_ * ms, stall_ns_ * ms, starve_ns_ * ms};
}

}  // namespace occlod::hlod
