// Which attributes the corners of faces have while a mesh is simplified.
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

// Faces of one star that cannot be told apart.
class EqualFaces {
 public:
  // O(n log n).
  void find(const Star& star);
  // How many faces before the i-th are equal to it.
  [[nodiscard]] std::size_t rank(std::size_t i) const noexcept { return ranks_.empty() ? 0 : ranks_[i]; }

 private:
  std::vector<std::uint32_t> ranks_;  // empty: all are 0
  std::vector<std::pair<StarFace, std::uint32_t>> sorted_;
};

// A vertex all of whose corners have one wedge, as nearly all have, needs no more than its id. Collapses of vertices
// whose stars are disjoint may change a map in parallel.
class CornerMap {
 public:
  // Of the faces of `mesh`; `materials`: by wedge, or empty. Both outlive it.
  CornerMap(const TriangleMesh& mesh, std::span<const MaterialId> materials);

  // The wedges of a face at v: of the input, whose attributes its corners have; their vertices may be others. They have
  // one material. `rank`: how many faces before it in star(v) StarMesh cannot tell from it, so that each takes its own.
  [[nodiscard]] Triangle wedges(VertexId v, const StarFace& face, std::size_t rank) const;
  // Whether the corners of v have several wedges.
  [[nodiscard]] bool is_on_seam(VertexId v) const noexcept { return !lists_[v].empty(); }
  // The first wedges at the corners of v in the material of `like`, each once, in an order that depends on the mesh
  // only. Appends no more than `most` to `out`.
  void wedges_at(VertexId v, WedgeId like, std::size_t most, std::vector<WedgeId>& out) const;

  // After `mesh` has merged v into u: the faces that were at v, and the wedge that u has now in each; for those with u
  // it is not read. `folded`: older faces, with u as their first corner, that ended with moved ones.
  void collapse(const StarMesh& mesh, VertexId v, VertexId u, CollapseId id, std::span<const StarFace> star,
                std::span<const WedgeId> wedges_of_u, std::span<const LevelFace> folded);

 private:
  struct Corner {
    StarFace face;  // as the vertex sees it
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
  std::vector<WedgeId> single_;             // of a vertex without a list
  std::vector<std::vector<Corner>> lists_;  // of a vertex whose corners differ, in the order of faces
};

// What threads share of attributes while they simplify a mesh that has texture coordinates or seams.

// Whether a mesh has attributes that simplification takes into account.
[[nodiscard]] inline bool has_wedge_attributes(const TriangleMesh& mesh) {
  return !mesh.extra_wedges.empty() || !mesh.texture_coordinates.empty();
}

// The material of each wedge; empty when triangles name none.
[[nodiscard]] std::vector<MaterialId> wedge_materials(const TriangleMesh& mesh);

// Indexed by wedge or by vertex of the input. A worker touches only vertices of its block.
struct AttributeState {
  // `scale`: from object units to those of the state. `mesh` outlives it.
  AttributeState(const TriangleMesh& mesh, float scale);

  const TriangleMesh& input;
  std::vector<MaterialId> materials;   // by wedge, or empty
  std::vector<float> texture_lengths;  // by wedge: of a step of 1 in texture space, in the state's scale
  std::vector<float> extents2;         // by wedge: a sixth of the area of its chart; what has left it slips no farther
  CornerMap corners;
  std::vector<float> sums;  // by vertex: weight times squared deviation, over all collapses that led to it
};

}  // namespace occlod
