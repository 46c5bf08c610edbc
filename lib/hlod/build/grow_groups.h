// Groups along the surface, where cells of space do not work.
#pragma once

#include <cstdint>
#include <span>

#include "hlod/build/group_triangles.h"

namespace occlod::hlod {

// Where triangles are much longer than the cells that so many of them fill, as on pipes with few bends, nearly all
// vertices are shared by several groups, so that nothing could be simplified. If groups with more shared corners than
// others have a quarter of the triangles or more, their triangles are grouped anew: from one triangle to those that
// share a vertex with it, and so on, until a group has `most_triangles`; what is left around it begins the next.
// `order` is all triangles along a Morton curve; groups are numbered along it. O(n).
void grow_stuck_groups(std::span<const Triangle> triangles, std::span<const std::uint32_t> order,
                       std::size_t vertex_count, std::uint32_t most_triangles, TriangleGroups& groups,
                       unsigned threads);

}  // namespace occlod::hlod
