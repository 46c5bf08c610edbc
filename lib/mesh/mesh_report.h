// The report of a mesh that is made of several objects, or in arrays that may be larger than memory.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "occlod/mesh.h"

namespace occlod {

// Adds what was counted when an object was read, and its vertices that no triangle uses.
void add_counts_of_reading(MeshReport& report, const MeshReport& of_object);

// Counts the triangles that were dropped and the vertices that were merged since reading, from how many are left: each
// vertex that was read is left, merged into another, or counted as unreferenced or not finite.
void settle_counts(MeshReport& report, std::uint64_t vertices, std::uint64_t triangles);

// Returns the report of a mesh made of what was read: of its own report, only seams and topology.
[[nodiscard]] MeshReport report_of(const MeshReport& read, const CleanMesh& made);

// Drops the features of a mesh that goes on without them, and counts them as left out.
void leave_out_features(CleanMesh& read);

// Does as count_topology() of a mesh. `positions` has those of vertices, without extra wedges.
void count_topology(std::span<const glm::vec3> positions, std::span<const Triangle> triangles, MeshReport& report,
                    int threads);

}  // namespace occlod
