// Tracks the attributes at the corners of faces while a mesh is simplified, and decides what collapses do to them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "occlod/mesh.h"
#include "splits/positions.h"
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

// Returns whether a mesh has attributes that simplification takes into account: not one colour everywhere.
[[nodiscard]] inline bool has_wedge_attributes(const TriangleMesh& mesh) {
  return !mesh.extra_wedges.empty() || !mesh.texture_coordinates.empty() || !mesh.normals.empty() ||
         std::ranges::adjacent_find(mesh.colors, std::ranges::not_equal_to{}) != mesh.colors.end();
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
  // expressed as a length on the surface. A chart that vanishes counts with its extent. Returns infinity, and leaves
  // the wedges unchosen, as soon as the result is known to be more than `most`.
  [[nodiscard]] float choose(VertexId u, float most = std::numeric_limits<float>::infinity());
  // Keeps the last choice for settle().
  void keep(VertexId u, float deviation2);
  // Makes the choice for u, which may have been kept, the last one. Returns what choose(u) does.
  [[nodiscard]] float settle(VertexId u);
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

  // The choice for one neighbour.
  struct Kept {
    VertexId u = no_id;
    float deviation2 = 0.0F;
    std::vector<WedgeId> wedges;  // per face
  };

  void group_charts();
  [[nodiscard]] std::pair<std::size_t, float> chart_from(std::size_t begin) const;
  [[nodiscard]] static Place place_in(const std::array<glm::vec3, 3>& corners);
  [[nodiscard]] float deviation2(std::size_t face, const glm::vec3& place, WedgeId wedge_of_u, float length2) const;
  [[nodiscard]] float color_change_at_edges2(std::size_t begin, std::size_t end, VertexId u, const glm::vec3& offset,
                                             float most) const;
  [[nodiscard]] float choose_for_chart(std::size_t begin, std::size_t end, VertexId u, const glm::vec3& offset,
                                       float most);
  void list_candidates(WedgeId own, VertexId u);
  [[nodiscard]] float extent2(std::size_t begin, std::size_t end) const;

  const AttributeState* state_ = nullptr;
  EqualFaces equal_;
  std::vector<StarFace> faces_;
  std::vector<Triangle> wedges_;
  std::vector<glm::vec3> next_, last_;  // per face, relative to v
  std::vector<float> areas_;            // twice the area of each face
  float area_ = 0.0F;                   // their sum, chart by chart
  std::vector<std::uint32_t> order_;    // faces sorted by chart
  std::vector<Place> places_;
  std::vector<WedgeId> chosen_;
  Kept kept_;
  std::vector<WedgeId> candidates_;
};

}  // namespace occlod
