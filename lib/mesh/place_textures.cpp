#include "mesh/place_textures.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "base/scratch_memory.h"

namespace occlod {
namespace {

constexpr std::size_t polygons_between_looks = 4096;  // whether memory has room

glm::vec2 placed(const glm::vec2& at, const MapPlacement& by) {
  const glm::dvec2 there = by.scale * glm::dvec2(at) + by.offset;
  return {to_float(there.x), to_float(there.y)};
}

}  // namespace

template <class Storage>
void place_textures(const BasicPolygonSoup<Storage>& soup, std::span<const MapPlacement> placements,
                    CornerAttributes<Storage>& attributes, const FileErrors& errors) {
  const MapPlacement as_it_is;
  auto& corners = attributes.corners;
  auto& coordinates = attributes.texture_coordinates;
  if (coordinates.empty() || std::ranges::count(placements, as_it_is) == std::ssize(placements)) return;
  typename Storage::template Array<std::uint32_t> copies(coordinates.size(), 0);  // by coordinate: its latest
  std::size_t run = coordinates.size();                                           // from here on copies are placed by:
  const MapPlacement* by = &as_it_is;
  std::size_t corner = 0;
  for (std::size_t polygon = 0; polygon < soup.polygon_count() && corner < corners.size(); ++polygon) {
    if (polygon % polygons_between_looks == 0) make_room();
    const std::size_t first = corner;
    corner += soup.corner_count(polygon);
    const MapPlacement& placement = placements[soup.polygon_materials[polygon]];
    if (placement == as_it_is) continue;
    if (placement != *by) {
      by = &placement;
      run = coordinates.size();
    }
    for (std::size_t i = first; i < std::min(corner, corners.size()); ++i) {
      std::uint32_t& index = corners[i].texture;
      if (index == no_id) continue;
      if (copies[index] < run) {
        if (coordinates.size() >= no_id)
          errors.fail("", "has too many texture coordinates of materials that scale or move them",
                      "split the mesh into parts");
        copies[index] = static_cast<std::uint32_t>(coordinates.size());
        coordinates.push_back(placed(coordinates[index], placement));
      }
      index = copies[index];
    }
  }
}

template void place_textures(const PolygonSoup&, std::span<const MapPlacement>, CornerAttributes<InMemory>&,
                             const FileErrors&);
template void place_textures(const ScratchSoup&, std::span<const MapPlacement>, CornerAttributes<InScratch>&,
                             const FileErrors&);

}  // namespace occlod
