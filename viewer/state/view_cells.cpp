#include "view_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <utility>

#include "occlod/base.h"
#include "occlod/cell_builder.h"

namespace occlod::viewer {

bool is_vlod_file(const std::filesystem::path& file) { return file.extension() == ".vlod"; }

std::vector<RefineObject> refine_objects(const Objects& objects) {
  std::vector<RefineObject> list;
  for (const PlacedObject& object : objects)
    list.push_back({object.mesh->hierarchy.get(), object.object_to_world, object.two_sided, object.attributes});
  return list;
}

std::shared_ptr<const ViewCells> open_view_cells(const std::filesystem::path& file,
                                                 std::shared_ptr<const Objects> objects) {
  if (objects->empty())
    throw Error({file.string(), "", "no scene is open that its cells could be of", "open it first"});
  if (are_hlods(*objects))
    throw Error({file.string(), "", "holds cells of hierarchies, and HLODs are open", "open its scene instead"});
  std::vector<std::string> names;
  for (const PlacedObject& object : *objects) names.push_back(object.name);
  auto cells = std::make_shared<ViewCells>();
  cells->path = file;
  cells->file = open_vlod(file, refine_objects(*objects), names);
  cells->objects = std::move(objects);
  const CellTree& tree = cells->file->tree();
  for (CellId c = 0; c < tree.nodes().size(); ++c) {
    const CellNode& node = tree.node(c);
    const std::uint64_t above = node.parent == no_id ? 0 : cells->path_bytes[node.parent];
    cells->path_bytes.push_back(above + node.payload_bytes);
    if (tree.is_leaf(c)) cells->leaves.push_back(c);
  }
  return cells;
}

bool are_of(const ViewCells& cells, const Objects& objects) {
  return std::equal(objects.begin(), objects.end(), cells.objects->begin(), cells.objects->end(),
                    [](const PlacedObject& a, const PlacedObject& b) {
                      return a.mesh == b.mesh && a.object_to_world == b.object_to_world && a.two_sided == b.two_sided &&
                             a.attributes == b.attributes;
                    });
}

std::string why_not_promised(const ViewCells& cells, const Camera& camera) {
  if (camera.orthographic_height) return "the picture is orthographic";
  const EyeModel& built = cells.file->options().cell.eyes;
  const EyeModel seen = eye_model(View(camera));
  constexpr double rounding = 1e-9;
  if (seen.focal_length_px > built.focal_length_px * (1.0 + rounding))
    return fmt::format("the picture magnifies {:.3g} times more", seen.focal_length_px / built.focal_length_px);
  const auto degrees = [](double cosine) { return 2.0 * glm::degrees(std::acos(cosine)); };
  if (seen.cos_corner_angle < built.cos_corner_angle * (1.0 - rounding))
    return fmt::format("the picture shows {:.1f} degrees from corner to corner instead of {:.1f}",
                       degrees(seen.cos_corner_angle), degrees(built.cos_corner_angle));
  if (seen.near < built.near * (1.0 - rounding))
    return fmt::format("the near plane is at {:.3g} instead of {:.3g}", seen.near, built.near);
  return "";
}

std::optional<Camera> promised_camera(const ViewCells& cells, const Camera& camera) {
  const EyeModel& built = cells.file->options().cell.eyes;
  const double half = std::tan(glm::radians(camera.fov_y_deg) / 2.0);
  Camera smaller = camera;
  smaller.height = std::min(camera.height, static_cast<int>(2.0 * built.focal_length_px * half + 1e-6));
  const double focal = smaller.height / 2.0 / half;
  const double diagonal = 2.0 * focal * std::tan(std::acos(built.cos_corner_angle));
  const double rest = diagonal * diagonal - static_cast<double>(smaller.height) * smaller.height;
  smaller.width = std::min(camera.width, static_cast<int>(std::sqrt(std::max(rest, 0.0)) + 1e-6));
  if (smaller.width < 1 || smaller.height < 1 || !why_not_promised(cells, smaller).empty()) return std::nullopt;
  return smaller;
}

std::vector<CellId> nearest_leaves(const ViewCells& cells, const glm::dvec3& point, std::size_t most) {
  if (cells.leaves.size() <= most) return cells.leaves;
  std::vector<std::pair<double, CellId>> by_distance;
  for (const CellId leaf : cells.leaves) {
    const CellBox& box = cells.file->tree().node(leaf).box;
    by_distance.emplace_back(glm::distance(point, glm::clamp(point, box.min, box.max)), leaf);
  }
  const auto end = by_distance.begin() + static_cast<std::ptrdiff_t>(most);
  std::nth_element(by_distance.begin(), end, by_distance.end());
  std::vector<CellId> leaves;
  for (auto at = by_distance.begin(); at != end; ++at) leaves.push_back(at->second);
  std::sort(leaves.begin(), leaves.end());
  return leaves;
}

}  // namespace occlod::viewer
