// Decides which half-edge collapses keep the topology and do not flip a face.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "occlod/hierarchy.h"
#include "splits/positions.h"
#include "splits/star.h"
#include "splits/star_mesh.h"

namespace occlod {

// Holds the data that all collapses of one vertex v share: computed once for v, then evaluated for each target. Faces
// with the same corners, such as both sides of a sheet, move together and count as one.
class VertexRing {
 public:
  void gather(const StarMesh& mesh, VertexId v);

  [[nodiscard]] VertexId vertex() const noexcept { return vertex_; }
  [[nodiscard]] std::span<const VertexId> neighbours() const noexcept { return neighbours_; }
  // Returns the index of u among the neighbours, if it is one. O(log neighbours).
  [[nodiscard]] std::optional<std::size_t> place_of(VertexId u) const;
  // Returns the different faces at v.
  [[nodiscard]] std::span<const StarFace> faces() const noexcept { return faces_; }
  // Returns the number of different faces at the edge from v to neighbour i.
  [[nodiscard]] int degree(std::size_t i) const noexcept { return degrees_[i]; }
  // Returns false when v is a non-manifold corner: it has several fans, or feature edges (those without exactly two
  // faces) that do not pass through v as one line of constant degree.
  [[nodiscard]] bool movable() const noexcept { return movable_; }
  // Returns true when v lies on a line of feature edges; it may then move only along that line.
  [[nodiscard]] bool on_feature() const noexcept { return on_feature_; }

 private:
  [[nodiscard]] bool one_fan() const;

  VertexId vertex_ = no_id;
  std::vector<StarFace> faces_;
  std::vector<VertexId> neighbours_;
  std::vector<int> degrees_;
  bool movable_ = false;
  bool on_feature_ = false;
  mutable std::vector<std::uint32_t> fan_of_;
};

// Returns whether the faces at the vertex that a split adds are those that it inserts there, so that the collapse it
// undoes can be repeated.
[[nodiscard]] bool has_inserted_star(const StarMesh& mesh, const SplitStar& star);

// Tests the link condition for merging v into its i-th neighbour (Dey, Edelsbrunner, Guha, Nekhayev 1999): the links of
// both ends meet only in the link of the edge, where feature edges are coned to an extra vertex. The result is then
// homeomorphic to the mesh before.
[[nodiscard]] bool keeps_topology(const StarMesh& mesh, const VertexRing& ring, std::size_t i);

// The same, but a vertex that is not movable, where surfaces touch, may move as well if nothing is lost: no face is
// folded onto another, and no edge is left without a face. Sliding v to u then covers the result.
[[nodiscard]] bool keeps_surface(const StarMesh& mesh, const VertexRing& ring, std::size_t i);

// Returns true iff no face that moves when v is merged into u turns by more than about 75 degrees or degenerates. Faces
// that had no area before are not tested.
[[nodiscard]] bool keeps_orientation(const StarMesh& mesh, const PositionView& positions, VertexId v, VertexId u);

// Bounds how far one collapse can move the surface. The bound is guaranteed, not an estimate.

// Bounds the two-sided distance between the star of v and the faces that replace it after v is merged into u. Two maps
// between the surfaces are tried and the smaller bound wins:
// - sliding v to u, which moves every point by at most |vu|;
// - the identity of a common projection: where the old and the new triangles of one fan project without overlap onto
//   the same polygon, the height between them is linear in each cell of the overlay of both triangulations, hence
//   largest at one of its corners (v itself and crossings of old with new edges). A vertex on a feature line is first
//   slid onto the line's new course, which adds that distance.
// (After Cohen, Varshney, Manocha et al. 1996, "Simplification envelopes", and Bajaj & Schikore 1996, "Error-bounded
// reduction".)
class ChangeBound {
 public:
  // Returns the bound in object units, rounded upwards. `ring` must have been gathered for v.
  [[nodiscard]] double operator()(const PositionView& positions, const VertexRing& ring, VertexId u);

 private:
  // Holds one fan of faces around v: its corners in 3D and in the projection, in order; closed when the last joins the
  // first.
  struct Page {
    std::vector<glm::dvec3> corners;
    bool closed = false;
  };
  [[nodiscard]] bool next_page(const PositionView& positions, const VertexRing& ring);
  [[nodiscard]] double page_bound(const glm::dvec3& apex, const glm::dvec3& target);

  Page page_;
  std::vector<StarFace> open_faces_;
  std::vector<glm::dvec2> flat_;
};

}  // namespace occlod
