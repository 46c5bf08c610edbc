// Disks that are slower than this machine's, for walks through view cells.
#pragma once

#include <cstdint>
#include <functional>

#include "cells/cell_loads.h"

namespace occlod::tool {

// How fast a disk is.
struct DiskSpeed {
  double bytes_per_second = 100e6;  // > 0
  double latency_seconds = 5e-3;    // of each read, >= 0
};

// `reader`, after waiting as long as this disk would take for what the node adds. `wait`: called with seconds, on the
// thread that reads; it sleeps, or moves a clock of its own. The file outlives the reader.
[[nodiscard]] CellReader throttled(CellReader reader, const VlodFile& file, const DiskSpeed& disk,
                                   std::function<void(double seconds)> wait);

// The same for WalkTrial::before_geometry.
[[nodiscard]] std::function<void(std::uint64_t bytes)> throttled_geometry(const DiskSpeed& disk,
                                                                          std::function<void(double seconds)> wait);

}  // namespace occlod::tool
