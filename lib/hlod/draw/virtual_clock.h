// Keeps the two clocks of a device whose time is computed, not measured.
#pragma once

#include <algorithm>
#include <cstdint>

#include "occlod/device.h"

namespace occlod::hlod {

// Models a processor that submits commands and a device that executes them in order, in parallel. Times are in ns and
// exact as long as all are whole numbers below 2^53.
class VirtualClock {
 public:
  void begin() { *this = {}; }
  // Lets the processor work by itself.
  void work(double ns) { cpu_ns_ += ns; }
  // Submits a command, which takes the processor submit_ns and then the device command_ns. Returns when it is done.
  double command(double submit_ns, double command_ns) {
    cpu_ns_ += submit_ns;
    const double start = std::max(cpu_ns_, gpu_ns_);
    if (commands_ > 0) starve_ns_ += start - gpu_ns_;
    gpu_ns_ = start + command_ns;
    busy_ns_ += command_ns;
    ++commands_;
    return gpu_ns_;
  }
  // Lets the processor wait until this time.
  void wait_until(double ns) {
    if (ns <= cpu_ns_) return;
    stall_ns_ += ns - cpu_ns_;
    cpu_ns_ = ns;
  }

  [[nodiscard]] double cpu_ns() const noexcept { return cpu_ns_; }
  // Returns the number of submitted commands.
  [[nodiscard]] std::uint64_t commands() const noexcept { return commands_; }
  [[nodiscard]] FrameTimes times() const noexcept {
    constexpr double ms = 1e-6;
    return {std::max(cpu_ns_, gpu_ns_) * ms, cpu_ns_ * ms, busy_ns_ * ms, stall_ns_ * ms, starve_ns_ * ms};
  }

 private:
  double cpu_ns_ = 0.0, gpu_ns_ = 0.0;
  double busy_ns_ = 0.0, stall_ns_ = 0.0, starve_ns_ = 0.0;
  std::uint64_t commands_ = 0;
};

}  // namespace occlod::hlod
