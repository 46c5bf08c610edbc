// Packed .vlod files: view cells with all the geometry that they draw, so that no hierarchy is needed to walk.
#pragma once

#include <filesystem>
#include <functional>
#include <span>

#include "occlod/refine/refiner.h"
#include "occlod/viewcells/vlod_file.h"

namespace occlod {

// How a file is packed.
struct PackOptions {
  int level = 12;  // of zstd, in [1, 19]; 0: the geometry is not compressed
  // Called now and then with the share done, in [0, 1]; returning false cancels, which then throws Error.
  std::function<bool(double)> progress = {};
};

// Writes the same cells as a packed file. Its splits are numbered anew, in an order in which those of a cell are few
// runs and every split comes after those that it needs; those that no cell applies are left out. `file`: opened with
// `objects`; it may be packed itself. The file appears whole or not at all, and the same cells and level give the same
// bytes. Throws Error when the file is damaged, an option is out of its range, or nothing can be written.
// O(n log n) in what all nodes add; memory: that, and the file to be written.
void pack_cells(const VlodFile& file, std::span<const RefineObject> objects, const std::filesystem::path& path,
                const PackOptions& options = {});

}  // namespace occlod
