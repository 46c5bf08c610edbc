#include "support/memory.h"

#include <malloc.h>

#include <fstream>
#include <string>

namespace occlod::bench {
namespace {

// A line such as "VmHWM:     1234 kB" of /proc/self/status (proc(5)).
std::optional<std::uint64_t> status_bytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kib = 0;
    if (word == key + ":" && status >> kib) return kib * 1024;
  }
  return {};
}

}  // namespace

std::optional<std::uint64_t> restart_peak() {
  malloc_trim(0);
  std::ofstream clear("/proc/self/clear_refs");
  clear << "5" << std::flush;  // resets VmHWM
  if (!clear) return {};
  return status_bytes("VmRSS");
}

std::optional<std::uint64_t> peak_bytes() { return status_bytes("VmHWM"); }

}  // namespace occlod::bench
