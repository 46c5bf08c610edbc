// The mesh while it is being simplified: plain indices, faces around every vertex, any topology.
#pragma once

#include <cstddef>
#include <memory>
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

// Memory for stars that outgrow their first place. Given back all at once, so it outlives the mesh; one for each thread
// that collapses.
class StarArena {
 public:
  [[nodiscard]] FaceId* allocate(std::size_t count);

 private:
  static constexpr std::size_t chunk_size = 1U << 16;
  std::vector<std::unique_ptr<FaceId[]>> chunks_;
  std::size_t left_ = 0;
};

// Faces are slots: a face that a collapse moves keeps its slot and changes a corner. Collapses whose stars, rings
// included, are disjoint may run in parallel, each with an arena of its own.
class StarMesh {
 public:
  StarMesh(std::span<const Triangle> faces, std::size_t vertex_count);

  [[nodiscard]] const Triangle& face(FaceId f) const noexcept { return faces_[f]; }
  [[nodiscard]] std::size_t face_count() const noexcept { return faces_.size(); }  // slots
  [[nodiscard]] std::span<const FaceId> star(VertexId v) const noexcept { return {stars_[v].faces, stars_[v].count}; }
  // The number of faces at edge ab.
  [[nodiscard]] int edge_degree(VertexId a, VertexId b) const noexcept;
  // The vertices that share a face with v, each once, ascending. `out` is cleared first.
  void neighbours(VertexId v, std::vector<VertexId>& out) const;
  // Slots in use, ascending.
  [[nodiscard]] std::vector<FaceId> live_faces() const;

  // Merges v into u: faces with both end, the others at v get u in its place. `may_fold`: a moved face may meet an old
  // one turned over; then both end, so that the oriented boundary (as a chain) stays that of the merged input. Calls
  // end(f) for every face that ends or moves while its slot still holds the old corners. Returns how many slots fall
  // out of use.
  template <typename End>
  std::size_t collapse(VertexId v, VertexId u, bool may_fold, StarArena& arena, const End& end);

 private:
  struct Star {
    FaceId* faces = nullptr;
    std::uint32_t count = 0;
    std::uint32_t capacity = 0;
  };

  void add_to_star(VertexId v, FaceId f, StarArena& arena);
  void remove_from_star(VertexId v, FaceId f) noexcept;
  // Among the first `count` faces of u the one with the corners of t in opposite winding order, or no_id.
  [[nodiscard]] FaceId find_reverse(const Triangle& t, VertexId u, std::uint32_t count) const noexcept;

  std::vector<Triangle> faces_;
  std::vector<Star> stars_;
  std::vector<FaceId> pool_;  // the first places of all stars
};

template <typename End>
std::size_t StarMesh::collapse(VertexId v, VertexId u, bool may_fold, StarArena& arena, const End& end) {
  const Star star = stars_[v];
  stars_[v].count = 0;
  std::size_t gone = 0;
  std::uint32_t moving = 0;
  for (std::uint32_t i = 0; i < star.count; ++i) {
    const FaceId f = star.faces[i];
    end(f);
    if (!contains(faces_[f], u)) {
      star.faces[moving++] = f;
      continue;
    }
    const OppositeEdge e = opposite_edge(faces_[f], v);
    remove_from_star(e.next, f);
    remove_from_star(e.last, f);
    ++gone;
  }
  std::uint32_t old_faces_of_u = stars_[u].count;
  for (std::uint32_t i = 0; i < moving; ++i) {
    const FaceId f = star.faces[i];
    const OppositeEdge e = opposite_edge(faces_[f], v);
    const Triangle moved(u, e.next, e.last);
    const FaceId twin = may_fold ? find_reverse(moved, u, old_faces_of_u) : no_id;
    if (twin == no_id) {
      faces_[f] = moved;
      add_to_star(u, f, arena);
      continue;
    }
    end(twin);
    for (const VertexId w : {e.next, e.last}) {
      remove_from_star(w, f);
      remove_from_star(w, twin);
    }
    remove_from_star(u, twin);
    --old_faces_of_u;
    gone += 2;
  }
  return gone;
}

}  // namespace occlod
