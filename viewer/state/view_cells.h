// View cells (.vlod) of the objects that are open.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "objects.h"
#include "occlod/refiner.h"
#include "occlod/vlod_file.h"

namespace occlod::viewer {

// Immutable.
struct ViewCells {
  std::filesystem::path path;
  std::shared_ptr<const Objects> objects;  // that the file was opened with: meshes, which it refers to
  std::shared_ptr<const VlodFile> file;
  std::vector<std::uint64_t> path_bytes;  // by node: of the file, of the node and all above it: what a jump there reads
  std::vector<CellId> leaves;             // ascending
};

[[nodiscard]] bool is_vlod_file(const std::filesystem::path& file);
[[nodiscard]] std::vector<RefineObject> refine_objects(const Objects& objects);

// Throws Error that says which object the file was not built for. Reads all of the hierarchies. `objects`: meshes.
[[nodiscard]] std::shared_ptr<const ViewCells> open_view_cells(const std::filesystem::path& file,
                                                               std::shared_ptr<const Objects> objects);

// Whether these are the objects that the cells were built for, where they were then.
[[nodiscard]] bool are_of(const ViewCells& cells, const Objects& objects);

// The leaves nearest to a point, `most` at most; ascending.
[[nodiscard]] std::vector<CellId> nearest_leaves(const ViewCells& cells, const glm::dvec3& point, std::size_t most);

}  // namespace occlod::viewer
