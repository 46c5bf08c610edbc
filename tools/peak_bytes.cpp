#include "peak_bytes.h"

#include <sys/resource.h>

#include <fstream>
#include <string>

namespace occlod::tool {

std::uint64_t peak_bytes() {
  // getrusage() does not forget what the process held that started this program.
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key; std::getline(status, key))
    if (std::uint64_t kib = 0; key == "VmHWM:" && status >> kib) return kib * 1024;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

}  // namespace occlod::tool
