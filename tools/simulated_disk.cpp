#include "simulated_disk.h"

#include <cmath>
#include <span>
#include <utility>

#include "occlod/base.h"

namespace occlod::tool {
namespace {

void check(const DiskSpeed& disk) {
  if (!(disk.bytes_per_second > 0.0) || !(disk.latency_seconds >= 0.0) || !std::isfinite(disk.latency_seconds))
    throw Error({"disk speed", "", "is out of its range", "give bytes per second > 0 and seconds >= 0"});
}

}  // namespace

CellReader throttled(CellReader reader, const VlodFile& file, const DiskSpeed& disk,
                     std::function<void(double seconds)> wait) {
  check(disk);
  return [reader = std::move(reader), &file, disk, wait = std::move(wait)](
             CellId cell, std::span<const CellAdditions* const> ancestors) {
    wait(disk.latency_seconds + file.tree().node(cell).payload_bytes / disk.bytes_per_second);
    return reader(cell, ancestors);
  };
}

std::function<void(std::uint64_t bytes)> throttled_geometry(const DiskSpeed& disk,
                                                            std::function<void(double seconds)> wait) {
  check(disk);
  return [disk, wait = std::move(wait)](std::uint64_t bytes) {
    wait(disk.latency_seconds + static_cast<double>(bytes) / disk.bytes_per_second);
  };
}

}  // namespace occlod::tool
