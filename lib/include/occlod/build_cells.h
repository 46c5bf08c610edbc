// Builds .vlod files: divides space into view cells and finds what to draw in each. In one piece, or in parts on any
// number of machines, which are merged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "occlod/cell_builder.h"
#include "occlod/refiner.h"
#include "occlod/vlod_file.h"

namespace occlod {

// A run of root cells in their order: regions as they are given, within each along a Hilbert curve.
struct CellRange {
  std::uint32_t first = 0;  // root cell
  std::uint32_t count = 0;  // of them, > 0
  friend bool operator==(const CellRange&, const CellRange&) = default;
};

// One scene and one set of options. Files of either kind are written beside their path first: what was there stays as
// it was when anything fails. The same objects and options give the same bytes, whatever the number of threads and
// however the root cells are cut into parts.
class CellBuild {
 public:
  // Prepares a build. Reads all of the hierarchies, which outlive the build. Throws Error for options out of their
  // range and hierarchies that are missing or damaged.
  CellBuild(std::span<const RefineObject> objects, const CellTreeOptions& options);
  ~CellBuild();
  CellBuild(const CellBuild&) = delete;
  CellBuild& operator=(const CellBuild&) = delete;

  // Counts the root cells of all regions.
  [[nodiscard]] std::uint32_t root_cell_count() const noexcept;
  // Returns the i-th of n runs of nearly the same length, i < n. Empty where there are fewer root cells.
  [[nodiscard]] CellRange shard(std::uint32_t i, std::uint32_t n) const;
  // Returns the name of the .vpart file of this range: another for another scene or other options.
  [[nodiscard]] std::string part_name(const CellRange& range) const;
  // Tells whether the file is there, whole, and what write_part() would write. O(bytes).
  [[nodiscard]] bool has_part(const std::filesystem::path& part, const CellRange& range) const;

  // Divides the root cells and writes them, on `threads` threads in [0, 1024], 0: one for each core; each has a
  // CellBuilder of its own. `progress` is called now and then on the calling thread with the share done, in [0, 1], at
  // last with 1 before the file is written; returning false cancels the build, and what it throws ends the build too.
  // Throws Error when it is cancelled, `threads` is out of its range or the file cannot be written.
  void write_part(const std::filesystem::path& part, const CellRange& range, int threads = 0,
                  const std::function<bool(double)>& progress = {});
  // Does the same for all root cells, and writes a .vlod file.
  void write(const std::filesystem::path& path, int threads = 0, const std::function<bool(double)>& progress = {});

  // Counts the cuts that were found so far: of cells, of what was divided, and of parts of cells that were not kept.
  [[nodiscard]] std::size_t cuts() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// Returns the .vpart files in a folder, by name. Throws Error when there is no such folder.
[[nodiscard]] std::vector<std::filesystem::path> cell_parts_in(const std::filesystem::path& folder);

// Writes the .vlod file of parts that together have every root cell; what several have is the same in all of them.
// Throws Error for a part that is damaged, parts of different scenes or options, and root cells that are missing.
// O(bytes); memory: the file and the sets of some parts.
void merge_cells(std::span<const std::filesystem::path> parts, const std::filesystem::path& path);

// Packed .vlod files: view cells with all the geometry that they draw, so that no hierarchy is needed to walk.

// Writes the same cells as a packed file. Its splits are numbered anew, in an order in which those of a cell are few
// runs and every split comes after those that it needs; those that no cell applies are left out. `file`: opened with
// `objects`; it may be packed itself. `progress` is called now and then with the share done, in [0, 1]; returning false
// cancels, which then throws Error. The file appears whole or not at all, and the same cells give the same bytes.
// Throws Error when the file is damaged or nothing can be written. O(n log n) in what all nodes add; memory: that, and
// the file to be written.
void pack_cells(const VlodFile& file, std::span<const RefineObject> objects, const std::filesystem::path& path,
                const std::function<bool(double)>& progress = {});

}  // namespace occlod
