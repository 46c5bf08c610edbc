// How merging one vertex into another changes the attributes around it.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "splits/attribute_state.h"
#include "splits/positions.h"
#include "splits/star_mesh.h"

namespace occlod {

// The corners around one vertex v: gathered once, then asked for each neighbour u.
//
// Each face (v, a, b) becomes (u, a, b) and needs a wedge of u. A chart is the faces of v with one wedge of it. A chart
// with the edge to u has a wedge of u there and keeps it: its texture stays in one piece. Any other chart takes what
// fits best of the wedges that u has in its material, or u gets another wedge with the attributes of v: the chart is
// stretched over u. So there is always a wedge, and every face keeps its material.
class AttributeStar {
 public:
  // Where corners with one wedge of v went.
  struct WedgeMerge {
    VertexId v = no_id;
    WedgeId wedge = no_id;  // of the input, whose attributes they had
    WedgeId into = no_id;   // whose attributes they have now, at u
    bool is_split = false;  // others of them went elsewhere: v had the end of u's seam
  };

  void gather(const StarMesh& mesh, const AttributeState& state, const PositionView& positions, VertexId v);

  [[nodiscard]] std::span<const StarFace> faces() const noexcept { return faces_; }
  // Of each face, v's first.
  [[nodiscard]] std::span<const Triangle> wedges() const noexcept { return wedges_; }

  // Chooses the wedges of u. Returns the mean square over the star's area, in the state's scale, of how far attributes
  // are off at v then: v's, as a length on the surface, against what the new faces interpolate where v was. A chart
  // that ends counts with its extent.
  [[nodiscard]] float choose(VertexId u);
  // For each face what choose() gave u; of faces with u no_id.
  [[nodiscard]] std::span<const WedgeId> wedges_of_u() const noexcept { return chosen_; }
  // The same chart by chart, for u of the last choose(). Charts that end are there too. Appends.
  void list_merges(VertexId v, VertexId u, std::vector<WedgeMerge>& merges) const;

 private:
  // Where v is in a face (u, a, b) that a moved face becomes: barycentric coordinates.
  struct Place {
    glm::vec3 projected{0.0F};  // on the face's plane, also outside of it
    glm::vec3 nearest{0.0F};    // in the face
    float distance2 = 0.0F;     // to that point, in the plane
    bool is_known = false;      // the face has an area
  };

  void group_charts();
  [[nodiscard]] Place place_in(std::size_t face, const glm::vec3& u) const;
  [[nodiscard]] float deviation2(std::size_t face, const glm::vec3& place, WedgeId wedge_of_u, float length2) const;
  [[nodiscard]] float choose_for_chart(std::size_t begin, std::size_t end, VertexId u, float length2);
  void list_candidates(WedgeId own, VertexId u);
  [[nodiscard]] float extent2(std::size_t begin, std::size_t end) const;

  const AttributeState* state_ = nullptr;
  EqualFaces equal_;
  std::vector<StarFace> faces_;
  std::vector<Triangle> wedges_;
  std::vector<glm::vec3> next_, last_;  // of each face, from v
  std::vector<float> areas_;            // twice
  std::vector<std::uint32_t> order_;    // faces by their chart
  std::vector<Place> places_;
  std::vector<WedgeId> chosen_;
  std::vector<WedgeId> candidates_;
};

}  // namespace occlod
