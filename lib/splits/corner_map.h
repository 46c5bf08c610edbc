// Which attributes the corners of faces have while a mesh is simplified.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "occlod/mesh/triangle_mesh.h"
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

}  // namespace occlod
