// Builds .vlod files: divides space into view cells and finds what to draw in each.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

#include "occlod/refine/refiner.h"
#include "occlod/viewcells/cell_options.h"

namespace occlod {

// How a build runs; what it builds does not depend on it.
struct CellBuildRun {
  int threads = 0;  // in [0, 1024]; 0: one for each core. Each has a CellBuilder of its own
  // Called now and then on the calling thread with the share done, in [0, 1]; returning false cancels the build, which
  // then throws Error. What it throws ends the build too.
  std::function<bool(double)> progress = {};
};

// What a build did.
struct CellBuildStats {
  std::size_t cuts = 0;  // that were found: of cells, of what was divided, and of parts that were not kept
};

// Divides the regions and writes the file, beside `path` first: what was there stays as it was when anything fails. The
// same objects and options give the same bytes, whatever the number of threads. Throws Error for options out of their
// range, hierarchies that are missing or damaged, and when it is cancelled or the file cannot be written.
CellBuildStats build_cells(std::span<const RefineObject> objects, const CellTreeOptions& options,
                           const std::filesystem::path& path, const CellBuildRun& run = {});

}  // namespace occlod
