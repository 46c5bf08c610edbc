// Which attributes the corners of faces have while a mesh is simplified.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "occlod/mesh/triangle_mesh.h"
#include "star_mesh.h"

namespace occlod {

// A vertex all of whose corners have one wedge, as nearly all have, needs no more than its id. Collapses of vertices
// whose stars are disjoint may change a map in parallel.
class CornerMap {
 public:
  // Of the faces of `mesh`; `materials`: by wedge, or empty. Both outlive it.
  CornerMap(const TriangleMesh& mesh, std::span<const MaterialId> materials);

  // The wedges of a face at v, among those of star(v), which starts with `before`. They have one material. Of faces
  // that StarMesh cannot tell apart, each of its `before` equals takes one. A wedge is one of the input, whose
  // attributes the corner has; its vertex may be another.
  [[nodiscard]] Triangle wedges(VertexId v, const StarFace& face, std::span<const StarFace> before) const;
  // Whether the corners of v have several wedges.
  [[nodiscard]] bool is_on_seam(VertexId v) const noexcept { return !lists_[v].empty(); }
  // The wedges at the corners of v, each once, in an order that depends on the mesh only. Appends to `out`.
  void wedges_at(VertexId v, std::vector<WedgeId>& out) const;

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
  [[nodiscard]] WedgeId find(VertexId w, const StarFace& face, std::size_t rank, MaterialId material) const;
  void erase(VertexId w, const StarFace& face, WedgeId wedge);
  void erase_at_corners(const Triangle& corners, CollapseId made_by);
  void replace(VertexId w, const StarFace& face, const StarFace& by);
  void settle(VertexId w);

  std::span<const MaterialId> materials_;
  std::vector<WedgeId> single_;             // of a vertex without a list
  std::vector<std::vector<Corner>> lists_;  // of a vertex whose corners differ, in the order of faces
};

}  // namespace occlod
