#include "occlod/refine/material_ranges.h"

#include <algorithm>

namespace occlod {

void group_by_material(const Hierarchy& hierarchy, std::span<const Triangle> triangles, MaterialRanges& out) {
  std::vector<std::uint32_t> places(std::max<std::size_t>(hierarchy.data().materials.size(), 1), 0);
  for (const Triangle& t : triangles) ++places[hierarchy.material_of(t.x)];
  out.ranges.clear();
  std::uint32_t next = 0;
  for (std::size_t m = 0; m < places.size(); ++m) {
    const std::uint32_t count = places[m];
    if (count > 0) out.ranges.push_back({static_cast<MaterialId>(m), next, count});
    places[m] = next;
    next += count;
  }
  out.triangles.resize(triangles.size());
  for (const Triangle& t : triangles) out.triangles[places[hierarchy.material_of(t.x)]++] = t;
}

}  // namespace occlod
