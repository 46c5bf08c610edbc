// Writes the records that SplitCorners reads, and checks those of unknown origin.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "occlod/core/ids.h"
#include "occlod/hierarchy/split_corners.h"

namespace occlod {

// Appends the wedges of the faces that the star inserts, by slot. Nothing where all are the first ones of their
// vertices. O(faces).
void append_corners(const SplitStar& star, std::span<const Triangle> wedges, std::vector<std::uint32_t>& words);

// Whether `wedge` is one of that vertex. `extra_wedges`: see HierarchyView; `vertices`: how many there are.
[[nodiscard]] inline bool is_wedge_of(WedgeId wedge, VertexId vertex, std::span<const VertexId> extra_wedges,
                                      std::size_t vertices) noexcept {
  if (wedge < vertices) return wedge == vertex;
  return wedge - vertices < extra_wedges.size() && extra_wedges[wedge - vertices] == vertex;
}

// Whether a record can be read safely and names wedges of the vertices of the star of split s, which has been checked.
// Returns what is wrong, or nothing.
[[nodiscard]] std::optional<std::string> check_corners(const SplitStar& star, std::span<const std::uint32_t> record,
                                                       SplitId s, std::span<const VertexId> extra_wedges,
                                                       std::size_t vertices);

}  // namespace occlod
