// How far triangles are from a mesh: an upper bound that holds for every point of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "splits/reference_mesh.h"
#include "splits/triangle_batch.h"

namespace occlod {

// Halves the triangle until every piece is near one face of the mesh. A face is convex, so its distance is a convex
// function: a piece is no farther from it than the farthest of the piece's corners. Nothing is asked of the mesh.
class FaceDistance {
 public:
  explicit FaceDistance(const ReferenceMesh& mesh) : mesh_(mesh), is_taken_(mesh.face_count(), 0) {}

  // A bound on the distance of every point of the triangle from the input: that from a face of the mesh and the face's
  // own error together. Refined until it is at most `wanted` or nearly exact; infinite when it is not below `useful`.
  // The corners are vertices of the mesh.
  [[nodiscard]] float bound(const Triangle& corners, float wanted, float useful);

 private:
  using Piece = std::array<glm::vec3, 3>;
  struct NearFace {
    std::uint32_t face;      // of the mesh
    std::uint32_t triangle;  // into triangles_, no_id until it is needed
  };

  void gather(const Triangle& corners);
  void refine(const Piece& piece, std::size_t first);
  void halve(const Piece& piece, std::size_t first);
  void keep_close(const glm::vec3& center, float radius, std::size_t first, std::size_t end);
  [[nodiscard]] float measure(const Piece& piece, const glm::vec3& center, std::size_t first, std::size_t end);
  [[nodiscard]] const TriangleBatch& triangle_of(NearFace& near);
  [[nodiscard]] float enough() const;

  const ReferenceMesh& mesh_;
  std::vector<char> is_taken_;  // of each face
  std::vector<std::uint32_t> taken_;
  std::vector<NearFace> near_;
  std::vector<TriangleBatch> triangles_;
  float widest_ = 0.0F;  // radius of the widest face in near_
  // One triangle's state.
  float wanted_ = 0.0F, useful_ = 0.0F;
  float at_least_ = 0.0F;  // no bound is smaller: the distance of some point of the triangle
  float bound_ = 0.0F;     // of the pieces that are done
  std::size_t pieces_left_ = 0;
  std::vector<std::uint32_t> candidates_;  // into near_; a stack: a piece's from some index on, then those of its parts
};

}  // namespace occlod
