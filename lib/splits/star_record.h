// Names the shapes of the faces around one vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/hierarchy.h"
#include "occlod/mesh.h"
#include "splits/star.h"

namespace occlod {

enum class StarShape : std::uint8_t { closed_fan, open_fan, other };

// Writes the records that SplitStar reads, and checks records from untrusted sources.

struct RemovedFace {
  FaceRef ref;
  Triangle corners;
};

// Holds the contents of a record. The inserted faces of a fan are in ring order, each with v as its first corner.
struct StarContents {
  VertexId u = no_id;
  StarShape shape = StarShape::other;
  std::span<const Triangle> inserted;
  std::span<RemovedFace> removed;         // reordered when they are those that a fan implies
  std::span<const SplitId> dependencies;  // ascending
};

// Appends the shortest record that holds the star.
void append_star(const StarContents& star, std::vector<std::uint32_t>& words);

// Describes a closed fan of which every removed face is known: those without the parent vertex, in the order of its
// slots.
struct FanContents {
  std::span<const VertexId> ring;
  std::size_t parent_place = 0;
  std::span<const FaceRef> removed;
};

// Appends the record of a fan. Returns false, and appends nothing, when the star does not fit into a short record.
[[nodiscard]] bool append_fan(const FanContents& fan, std::vector<std::uint32_t>& words);

// Checks that a record and its ids can be read safely: it ends where the next begins, its corners are vertices that
// exist once split s is applied (at most its own), and its dependencies and the splits of removed faces are smaller
// than s. Returns a description of the problem, or nothing.
[[nodiscard]] std::optional<std::string> check_star(std::span<const std::uint32_t> record, SplitId s, VertexId vertex,
                                                    std::size_t base_faces);

// Writes the records that SplitCorners reads, and checks records from untrusted sources.

// Appends the wedges of the faces that the star inserts, by slot; appends nothing where all are the first wedges of
// their vertices. O(faces).
void append_corners(const SplitStar& star, std::span<const Triangle> wedges, std::vector<std::uint32_t>& words);

// Returns whether `wedge` belongs to that vertex. `extra_wedges`: see HierarchyView; `vertices`: the number of
// vertices.
[[nodiscard]] inline bool is_wedge_of(WedgeId wedge, VertexId vertex, std::span<const VertexId> extra_wedges,
                                      std::size_t vertices) noexcept {
  if (wedge < vertices) return wedge == vertex;
  return wedge - vertices < extra_wedges.size() && extra_wedges[wedge - vertices] == vertex;
}

// Checks that a record can be read safely and names wedges of the vertices of the star of split s, which has already
// been checked. Returns a description of the problem, or nothing.
[[nodiscard]] std::optional<std::string> check_corners(const SplitStar& star, std::span<const std::uint32_t> record,
                                                       SplitId s, std::span<const VertexId> extra_wedges,
                                                       std::size_t vertices);

}  // namespace occlod
