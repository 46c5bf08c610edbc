// The mesh while it is being simplified: plain indices, faces around every vertex, any topology.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "occlod/core/ids.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

[[nodiscard]] constexpr bool contains(const Triangle& t, VertexId v) noexcept {
  return t.x == v || t.y == v || t.z == v;
}

// The corners of a triangle that follow `v` in its winding order. Precondition: contains(t, v).
struct OppositeEdge {
  VertexId next;
  VertexId last;
};
[[nodiscard]] constexpr OppositeEdge opposite_edge(const Triangle& t, VertexId v) noexcept {
  if (t.x == v) return {t.y, t.z};
  if (t.y == v) return {t.z, t.x};
  return {t.x, t.y};
}

// A face keeps its id for ever; a collapse ends some faces and makes new ones with larger ids.
class StarMesh {
 public:
  StarMesh(std::span<const Triangle> faces, std::size_t vertex_count);

  [[nodiscard]] const Triangle& face(FaceId f) const noexcept { return faces_[f]; }
  [[nodiscard]] std::size_t face_count() const noexcept { return faces_.size(); }  // ever made
  [[nodiscard]] std::size_t live_face_count() const noexcept { return live_; }
  [[nodiscard]] std::span<const FaceId> star(VertexId v) const noexcept {
    return {pool_.data() + stars_[v].first, stars_[v].count};
  }
  // The number of live faces at edge ab.
  [[nodiscard]] int edge_degree(VertexId a, VertexId b) const noexcept;
  // The vertices that share a face with v, each once, ascending. `out` is cleared first.
  void neighbours(VertexId v, std::vector<VertexId>& out) const;

  // Merges v into u. Faces with both end; the others at v are made again with u in its place, except that a pair of
  // coincident faces with opposite winding, one old and one new, ends too: a closed sliver that folds flat is gone.
  // This keeps the oriented boundary (as a chain) exactly that of the merged input. Ended faces are appended to
  // `ended`; new ones have ids from face_count() on.
  void collapse(VertexId v, VertexId u, std::vector<FaceId>& ended);

  // Live faces, ascending.
  [[nodiscard]] std::vector<FaceId> live_faces() const;

  // The corners of all faces ever made; leaves the mesh empty.
  [[nodiscard]] std::vector<Triangle> release_faces() noexcept { return std::move(faces_); }

 private:
  struct Star {
    std::size_t first = 0;
    std::uint32_t count = 0;
    std::uint32_t capacity = 0;
  };

  void add_to_star(VertexId v, FaceId f);
  void remove_from_star(VertexId v, FaceId f);
  void replace_in_star(VertexId v, FaceId old_face, FaceId new_face);
  [[nodiscard]] FaceId find_reverse(const Triangle& t, VertexId at, FaceId end) const noexcept;

  std::vector<Triangle> faces_;
  std::vector<Star> stars_;
  std::vector<FaceId> pool_;
  std::size_t live_ = 0;
};

}  // namespace occlod
