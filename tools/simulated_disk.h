// Simulates slower disks for walks through view cells.
#pragma once

#include <cstdint>
#include <functional>

#include "cells/cell_loads.h"

namespace occlod::tool {

// Describes the speed of a disk.
struct DiskSpeed {
  double bytes_per_second = 100e6;  // > 0
  double latency_seconds = 5e-3;    // per read, >= 0
};

// Returns `reader` with a wait before it for as long as this disk would take to read what the node adds. `wait` is
// called with seconds on the reading thread; it sleeps, or advances a clock. The file must outlive the reader.
[[nodiscard]] CellReader throttled(CellReader reader, const VlodFile& file, const DiskSpeed& disk,
                                   std::function<void(double seconds)> wait);

// Returns the same wait for WalkTrial::before_geometry.
[[nodiscard]] std::function<void(std::uint64_t bytes)> throttled_geometry(const DiskSpeed& disk,
                                                                          std::function<void(double seconds)> wait);

}  // namespace occlod::tool
