// Which faces of a mesh still hide what they hide when the mesh is not exactly where it is said to be.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <utility>
#include <vector>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod {

// A face that is seen from the eye, and how far the surface that it stands for may be from it.
struct SheetFace {
  Triangle corners;
  float error = 0.0F;  // object units
};

// Faces that share an edge and lie on either side of it as seen from the eye are one sheet; other edges are its
// border. Take a ray through a point of a sheet that is farther from the whole border, as seen from the eye, than that
// border may have moved. The true surface is a deformation of the sheet whose border has not crossed the ray, so it
// still meets the ray as often as the sheet does, counted with sign: once. So it is there that the sheet hides what
// lies behind it by more than its error; nearer to its border it may have been pulled aside.
//
// Distances are between directions from the eye. Along edges the distance from the border is bounded from below by a
// function that differs by no more than a triangle's smallest height within it: its slope is at most 1.
//
// Reuses its memory.
class SheetErosion {
 public:
  // For each face 1 where it is kept, else 0; valid until the next call. O(n log n).
  std::span<const std::uint8_t> kept(std::span<const SheetFace> faces, std::span<const glm::vec3> positions,
                                     const glm::vec3& eye);

 private:
  struct Edge {
    std::uint32_t a = 0, b = 0;  // local vertices, a < b
    std::uint32_t face = 0;
    bool left = false;  // of the plane through the eye, a and b
  };

  void number_vertices(std::span<const SheetFace> faces, std::span<const glm::vec3> positions, const glm::vec3& eye);
  void measure(std::span<const SheetFace> faces, std::span<const glm::vec3> positions, const glm::vec3& eye);
  void find_border();
  void mark_border(std::span<const Edge> same);
  void spread();
  void list_faces_of_vertices();

  std::vector<std::uint32_t> vertices_;  // as the faces name them, ascending
  std::vector<glm::dvec3> directions_;   // of local vertices, unit length
  std::vector<glm::uvec3> corners_;      // of faces, local vertices
  std::vector<double> height_, radius_;  // of faces: smallest; how far the surface may be, as seen
  std::vector<Edge> edges_;
  std::vector<double> margin_;  // of local vertices: distance to the border less its radius
  std::vector<std::uint32_t> first_face_, next_, face_list_;  // of local vertices
  std::vector<std::pair<double, std::uint32_t>> queue_;
  std::vector<std::uint8_t> kept_;
};

}  // namespace occlod
