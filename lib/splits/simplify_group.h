// Simplifies one small mesh that is part of a larger one, keeping locked vertices in place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "occlod/mesh.h"

namespace occlod {

// Sets how far one group is simplified.
struct GroupTarget {
  // a power of two, equal for all groups whose costs are compared; scales their common mesh's extent into [1/2, 1]
  float scale = 1.0F;
  double boundary_weight = 1.0;                        // as in BuildOptions
  float max_cost = std::numeric_limits<float>::max();  // collapses that cost more are not made
  std::size_t min_triangles = 0;                       // ends when at most this many are left
  bool keeps_collapses = false;                        // whether SimplifiedGroup::collapses is wanted
  double attribute_weight = 0.0;                       // as in BuildOptions; 0: attributes do not count
  // Whether guaranteed_error is wanted. Without it, bounds and collapses, simplifying takes a third less time.
  bool keeps_bounds = true;
  bool lists_bounds = false;  // whether SimplifiedGroup::bounds are wanted
  // Whether vertices that are left move to where they fit the input best (refit.h). Needs keeps_bounds, and no
  // collapses.
  bool refits = false;
  float lattice_step = 0.0F;             // RefitRules::lattice_step
  std::span<const std::uint8_t> held{};  // per vertex, nonzero: does not move, but may be merged; empty: none
};

// Records that wedge v was merged into u. All wedges of a vertex are merged together, listed one after the other.
struct GroupCollapse {
  WedgeId v = no_id;
  WedgeId u = no_id;
  float error = 0.0F;  // object units; at least that of any collapse on which it depends
};

// Describes a wedge that a collapse added: a vertex with the attributes of another vertex's wedge.
struct AddedWedge {
  VertexId vertex = no_id;
  WedgeId attributes = no_id;  // wedge of the input
};

// Holds a simplified group. Wedges are those of the input, followed by `added`; if the input has no extra wedges they
// are its vertices, and none is added.
struct SimplifiedGroup {
  std::vector<Triangle> triangles;   // the remaining ones, by vertices of the input
  std::vector<Triangle> corners;     // their wedges; empty when the input has no extra wedges
  std::vector<AddedWedge> added;     // numbered after the wedges of the input
  std::vector<WedgeId> merged_into;  // per wedge: the wedge it ended up in; itself if not merged
  std::vector<glm::vec3> positions;  // per vertex of the input, where it is now; empty where none has moved
  float error = 0.0F;                // largest error of a collapse, object units: quadric error or attribute deviation
  float guaranteed_error = 0.0F;     // bound on the distance of every remaining triangle from the input, object units
  // Per triangle: no point of it is farther from the input, object units. Filled only on request.
  std::vector<float> bounds;
  float cost = 0.0F;  // of the most expensive collapse, for GroupTarget::max_cost
  // Lists collapses by descending error, each before those on which it depends: the others stay valid without the first
  // k. Filled only on request, and empty where corners with one wedge went to several: no such list could undo that.
  std::vector<GroupCollapse> collapses;
};

// Collapses edges of `mesh`, cheapest first, as build_hierarchy() does. A vertex v with locked[v] != 0 is never merged
// into another, but others may be merged into it; empty: none is locked. The oriented boundary of the result, as a
// chain, is the image under merged_into of that of `mesh`. Indices must be in range and positions finite.
// Single-threaded, deterministic; O(n log n).
[[nodiscard]] SimplifiedGroup simplify_group(const TriangleMesh& mesh, std::span<const std::uint8_t> locked,
                                             const GroupTarget& target);

}  // namespace occlod
