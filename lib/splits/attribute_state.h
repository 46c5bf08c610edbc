// Tracks the attributes at the corners of faces while a mesh is simplified.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <utility>
#include <vector>

#include "occlod/mesh.h"
#include "splits/star_mesh.h"

namespace occlod {

// Ranks faces of one star that have equal corners and maker.
class EqualFaces {
 public:
  // Finds the equal faces of a star. O(n log n).
  void find(const Star& star);
  // Returns how many faces before the i-th are equal to it.
  [[nodiscard]] std::size_t rank(std::size_t i) const noexcept { return ranks_.empty() ? 0 : ranks_[i]; }

 private:
  std::vector<std::uint32_t> ranks_;  // empty when all are 0
  std::vector<std::pair<StarFace, std::uint32_t>> sorted_;
};

// Maps corners to wedges. A vertex whose corners all have one wedge, which is the common case, stores only that id.
// Collapses of vertices with disjoint stars may change the map in parallel.
class CornerMap {
 public:
  // Starts from the faces of `mesh`. `materials` holds one material per wedge, or is empty. Both must outlive this
  // object.
  CornerMap(const TriangleMesh& mesh, std::span<const MaterialId> materials);

  // Returns the wedges of a face at v: the input wedges whose attributes its corners have; the vertices of these wedges
  // may differ from the corners. They have one material. `rank` is the number of earlier faces in star(v) that StarMesh
  // cannot tell from it, so that each gets its own wedges.
  [[nodiscard]] Triangle wedges(VertexId v, const StarFace& face, std::size_t rank) const;
  // Returns whether the corners of v have several wedges.
  [[nodiscard]] bool is_on_seam(VertexId v) const noexcept { return !lists_[v].empty(); }
  // Appends to `out` at most `most` of the wedges at the corners of v that have the material of `like`, each once, in
  // an order that depends only on the mesh.
  void wedges_at(VertexId v, WedgeId like, std::size_t most, std::vector<WedgeId>& out) const;

  // Updates the map after `mesh` has merged v into u. `star` holds the faces that were at v, and `wedges_of_u` the
  // wedge that u now has in each; entries of faces that contain u are not read. `folded` holds older faces, with u as
  // their first corner, that moved faces cancelled.
  void collapse(const StarMesh& mesh, VertexId v, VertexId u, CollapseId id, std::span<const StarFace> star,
                std::span<const WedgeId> wedges_of_u, std::span<const LevelFace> folded);

 private:
  struct Corner {
    StarFace face;  // as seen from the vertex
    WedgeId wedge;
  };

  [[nodiscard]] MaterialId material(WedgeId wedge) const noexcept {
    return materials_.empty() ? MaterialId{0} : materials_[wedge];
  }
  [[nodiscard]] WedgeId find(VertexId w, const StarFace& face, std::size_t rank, MaterialId of) const;
  void erase(VertexId w, const StarFace& face, WedgeId wedge);
  void erase_at_corners(const Triangle& corners, CollapseId made_by);
  void replace(VertexId w, const StarFace& face, const StarFace& by);
  void settle(VertexId w);

  std::span<const MaterialId> materials_;
  std::vector<WedgeId> single_;             // per vertex, used when it has no list
  std::vector<std::vector<Corner>> lists_;  // per vertex whose corners differ, in the order of its faces
};

// Returns whether a mesh has attributes that simplification takes into account.
[[nodiscard]] inline bool has_wedge_attributes(const TriangleMesh& mesh) {
  return !mesh.extra_wedges.empty() || !mesh.texture_coordinates.empty();
}

// Returns the material of each wedge; empty when triangles name none.
[[nodiscard]] std::vector<MaterialId> wedge_materials(const TriangleMesh& mesh);

// Holds the attribute data that threads share while they simplify a mesh with texture coordinates or seams. Indexed by
// wedge or vertex of the input. A worker accesses only vertices of its block.
struct AttributeState {
  // `scale` converts object units to the state's units. `mesh` must outlive this object.
  AttributeState(const TriangleMesh& mesh, float scale);

  const TriangleMesh& input;
  std::vector<MaterialId> materials;   // per wedge, or empty
  std::vector<float> texture_lengths;  // per wedge: length of a step of 1 in texture space, in the state's scale
  std::vector<float> extents2;         // per wedge: a sixth of its chart's area; caps the deviation
  CornerMap corners;
  std::vector<float> sums;  // per vertex: weight times squared deviation, over all collapses that led to it
};

}  // namespace occlod
