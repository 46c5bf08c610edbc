// An input mesh cut into small cells, each around one sample point.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "splits/level_faces.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

using SampleId = std::uint32_t;

// The cell of a vertex is its share of its triangles: of each, the quadrilateral between the vertex, the middles of
// two edges and the centroid. Triangles with an edge longer than a limit are cut into a regular lattice of small ones
// instead, each a cell around its own centroid. The limit is as small as leaves at most an eighth as many lattice cells
// as there are triangles. Keeps views of mesh and levels.
class SurfaceSamples {
 public:
  SurfaceSamples(const TriangleMesh& mesh, const LevelFaces& levels);

  [[nodiscard]] std::size_t size() const noexcept { return radii_.size(); }
  [[nodiscard]] glm::vec3 point(SampleId s) const noexcept {
    return s < mesh_.vertex_count() ? mesh_.positions[s] : lattice_[s - mesh_.vertex_count()].point;
  }
  // The cell lies in the ball of this radius round the point. Negative: the vertex has no cell.
  [[nodiscard]] float radius(SampleId s) const noexcept { return radii_[s]; }
  [[nodiscard]] float max_radius() const noexcept { return max_radius_; }
  // One face of the input for every sample that has a cell; it holds the point. Calls put(face, sample).
  template <typename Put>
  void place(const Put& put) const;
  // Appends the corners of the cell's convex pieces: no point of the cell is farther from a triangle than they are.
  void append_corners(SampleId s, std::vector<glm::vec3>& out) const;

 private:
  struct LatticeCell {
    FaceId face;
    std::uint32_t number;  // in the lattice of its triangle, row by row
    glm::vec3 point;
  };
  using Corners = std::array<glm::vec3, 3>;

  [[nodiscard]] float longest_edge(const Triangle& t) const;
  [[nodiscard]] std::uint32_t divisions(const Triangle& t) const;
  [[nodiscard]] Corners lattice_corners(const Triangle& t, std::uint32_t number) const;
  void choose_limit();
  void link_stars();
  void add_lattices();

  const TriangleMesh& mesh_;
  const LevelFaces& levels_;
  float limit_ = 0.0F;  // longest edge of a triangle that is shared out among its corners
  std::vector<std::uint32_t> first_star_;
  std::vector<std::uint32_t> stars_;  // the shared triangles at each vertex
  std::vector<LatticeCell> lattice_;
  std::vector<float> radii_;
  float max_radius_ = 0.0F;
};

template <typename Put>
void SurfaceSamples::place(const Put& put) const {
  std::vector<bool> placed(mesh_.vertex_count(), false);
  for (FaceId f = 0; f < levels_.face_count(); ++f) {
    if (levels_.maker(f) != no_id || longest_edge(levels_.corners(f)) > limit_) continue;
    for (int k = 0; k < 3; ++k) {
      const VertexId v = levels_.corners(f)[k];
      if (!placed[v]) put(f, v);
      placed[v] = true;
    }
  }
  for (std::size_t i = 0; i < lattice_.size(); ++i)
    put(lattice_[i].face, static_cast<SampleId>(mesh_.vertex_count() + i));
}

}  // namespace occlod
