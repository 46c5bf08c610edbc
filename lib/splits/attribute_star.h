// Decides how merging one vertex into another changes the attributes around it.
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

// Holds the corners around one vertex v: gathered once, then evaluated for each neighbour u.
//
// Each face (v, a, b) becomes (u, a, b) and needs a wedge of u. A chart is the set of faces that share one wedge of v.
// A chart with the edge to u has a wedge of u there and keeps it, so its texture stays in one piece. Any other chart
// takes the best fitting wedge that u has in its material, or u gets a new wedge with the attributes of v, which
// stretches the chart over u. So a wedge always exists, and every face keeps its material.
class AttributeStar {
 public:
  // Records what the corners with one wedge of v were merged into.
  struct WedgeMerge {
    VertexId v = no_id;
    WedgeId wedge = no_id;  // wedge of the input with their previous attributes
    WedgeId into = no_id;   // wedge at u with their new attributes
    bool is_split = false;  // other corners with this wedge went elsewhere: u's seam ended at v
  };

  void gather(const StarMesh& mesh, const AttributeState& state, const PositionView& positions, VertexId v);

  [[nodiscard]] std::span<const StarFace> faces() const noexcept { return faces_; }
  // Returns the wedges of each face, v's first.
  [[nodiscard]] std::span<const Triangle> wedges() const noexcept { return wedges_; }

  // Chooses the wedges of u. Returns the mean square, over the star's area and in the state's scale, of the attribute
  // deviation at v: the difference between v's attributes and those that the new faces interpolate at v's position,
  // expressed as a length on the surface. A chart that vanishes counts with its extent.
  [[nodiscard]] float choose(VertexId u);
  // Returns the wedge that choose() assigned to u in each face; no_id for faces that contain u.
  [[nodiscard]] std::span<const WedgeId> wedges_of_u() const noexcept { return chosen_; }
  // Appends, for the u of the last choose(), one merge per chart, charts that vanish included.
  void list_merges(VertexId v, VertexId u, std::vector<WedgeMerge>& merges) const;

 private:
  // Describes where v lies in a face (u, a, b) that a moved face becomes.
  struct Place {
    glm::vec3 projected{0.0F};  // barycentric; on the face's plane, possibly outside the face
    glm::vec3 nearest{0.0F};    // barycentric; nearest point in the face
    float distance2 = 0.0F;     // squared distance to that point, in the plane
    bool is_known = false;      // whether the face has an area
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
  std::vector<glm::vec3> next_, last_;  // per face, relative to v
  std::vector<float> areas_;            // twice the area of each face
  std::vector<std::uint32_t> order_;    // faces sorted by chart
  std::vector<Place> places_;
  std::vector<WedgeId> chosen_;
  std::vector<WedgeId> candidates_;
};

}  // namespace occlod
