// Simplifies one small mesh, part of a larger one, with vertices that stay where they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "occlod/mesh.h"

namespace occlod {

// How far one group is simplified.
struct GroupTarget {
  float scale = 1.0F;  // a power of two, the same for all groups whose costs are compared; takes the extent of their
                       // common mesh into [1/2, 1]
  double boundary_weight = 1.0;                        // as in BuildOptions
  float max_cost = std::numeric_limits<float>::max();  // collapses that cost more are not made
  std::size_t min_triangles = 0;                       // ends when no more are left
  bool keeps_collapses = false;                        // whether SimplifiedGroup::collapses is wanted
  double attribute_weight = 0.0;                       // as in BuildOptions; 0: attributes do not count
};

// Wedge v was merged into u: all wedges of a vertex at once, one after the other.
struct GroupCollapse {
  WedgeId v = no_id;
  WedgeId u = no_id;
  float error = 0.0F;  // object units; no less than that of any collapse that this one comes after
};

// A wedge that collapses have added: a vertex with the attributes of another one's wedge.
struct AddedWedge {
  VertexId vertex = no_id;
  WedgeId attributes = no_id;  // of the input
};

// What a group became. Wedges are those of the input, then `added`; of an input without extra wedges they are its
// vertices, and none is added.
struct SimplifiedGroup {
  std::vector<Triangle> triangles;   // that are left, by the vertices of the input
  std::vector<Triangle> corners;     // their wedges; empty when the input has no extra ones
  std::vector<AddedWedge> added;     // wedges, numbered after those of the input
  std::vector<WedgeId> merged_into;  // by wedge: the one that it ended up in; itself where it was not merged
  float error = 0.0F;  // the largest of a collapse, object units: quadric error, or how far attributes have slipped
  float guaranteed_error = 0.0F;  // no triangle that is left is farther from the input, object units
  float cost = 0.0F;              // of the dearest collapse, for GroupTarget::max_cost
  // By descending error, each before those that it comes after: without the last k, the mesh is what the others lead
  // to. Only if wanted, and none where corners with one wedge went to several: no such list leads back there.
  std::vector<GroupCollapse> collapses;
};

// Collapses edges of `mesh`, cheapest first, as build_hierarchy() does. A vertex v with locked[v] != 0 is never merged
// into another, but others may be merged into it; empty: none is locked. The oriented boundary of the result, as a
// chain, is the image under merged_into of that of `mesh`. Indices are in range and positions finite. On one thread,
// deterministic; O(n log n).
[[nodiscard]] SimplifiedGroup simplify_group(const TriangleMesh& mesh, std::span<const std::uint8_t> locked,
                                             const GroupTarget& target);

}  // namespace occlod
