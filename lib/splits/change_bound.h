// How far one collapse can move the surface: a bound that holds, not an estimate.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "splits/collapse_rules.h"
#include "splits/position_view.h"
#include "splits/star_mesh.h"

namespace occlod {

// Bounds the two-way distance between the star of v and what is left of it after v is merged into u. Two maps between
// the surfaces are tried and the smaller bound wins:
// - sliding v to u, which moves every point by at most |vu|;
// - the identity of a common projection: where the old and the new triangles of one fan project without overlap onto
// the same polygon, the height between them is
//   linear in each cell of the overlay of both triangulations, hence largest at one of its corners (v itself and
//   crossings of old with new edges). A vertex on a feature line is first slid onto the line's new course, which adds
//   that distance.
// (After Cohen, Varshney, Manocha et al. 1996, "Simplification envelopes", and Bajaj & Schikore 1996, "Error-bounded
// reduction".)
class ChangeBound {
 public:
  // Object units, rounded upwards. `ring` has been gathered for v.
  [[nodiscard]] double operator()(const StarMesh& mesh, const PositionView& positions, const VertexRing& ring,
                                  VertexId u);

 private:
  // One fan of faces around v: its corners in 3D and in the projection, in order; closed when the last joins the first.
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
