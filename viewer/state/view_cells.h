// Holds view cells (.vlod) of the open objects.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "objects.h"
#include "occlod/refiner.h"
#include "occlod/view.h"
#include "occlod/vlod_file.h"

namespace occlod::viewer {

// Never changes.
struct ViewCells {
  std::filesystem::path path;
  std::shared_ptr<const Objects> objects;  // the meshes that the file was opened with, and refers to
  std::shared_ptr<const VlodFile> file;
  std::vector<std::uint64_t> path_bytes;  // per node, bytes of it and all nodes above it, which a jump there reads
  std::vector<CellId> leaves;             // ascending
};

[[nodiscard]] bool is_vlod_file(const std::filesystem::path& file);
[[nodiscard]] std::vector<RefineObject> refine_objects(const Objects& objects);

// Throws Error that names an object that the file was not built for. Reads the hierarchies completely. `objects` are
// meshes.
[[nodiscard]] std::shared_ptr<const ViewCells> open_view_cells(const std::filesystem::path& file,
                                                               std::shared_ptr<const Objects> objects);

// Returns whether these are the objects that the cells were built for, at the same places.
[[nodiscard]] bool are_of(const ViewCells& cells, const Objects& objects);

// Returns why the promise of the cells does not hold for what the camera sees: which eyes it is about. Empty: it holds.
[[nodiscard]] std::string why_not_promised(const ViewCells& cells, const Camera& camera);

// Returns the camera with the largest picture, no larger than its own, for which the promise holds; nothing if no size
// of the picture helps.
[[nodiscard]] std::optional<Camera> promised_camera(const ViewCells& cells, const Camera& camera);

// Returns the leaves nearest to a point, at most `most`, ascending.
[[nodiscard]] std::vector<CellId> nearest_leaves(const ViewCells& cells, const glm::dvec3& point, std::size_t most);

}  // namespace occlod::viewer
