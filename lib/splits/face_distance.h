// Reads a collapse sequence face by face: which collapse made each face and which ended it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "splits/simplify.h"

namespace occlod {

using CollapseIndex = CollapseId;  // index into CollapseSequence::collapses
using FaceId = std::uint32_t;      // index into LevelFaces

// Numbers all faces that ever existed: those that ended, in their order, then those of the base mesh. Keeps a view of
// the sequence, which must outlive it.
class LevelFaces {
 public:
  explicit LevelFaces(const CollapseSequence& sequence);

  [[nodiscard]] CollapseIndex collapse_count() const noexcept {
    return static_cast<CollapseIndex>(sequence_.collapses.size());
  }
  [[nodiscard]] const Collapse& collapse(CollapseIndex c) const noexcept { return *sequence_.collapses[c]; }

  [[nodiscard]] FaceId face_count() const noexcept { return static_cast<FaceId>(faces_.size()); }
  [[nodiscard]] const Triangle& corners(FaceId f) const noexcept { return faces_[f].corners; }
  // Returns the collapse that made the face; no_id for faces of the input.
  [[nodiscard]] CollapseIndex maker(FaceId f) const noexcept { return faces_[f].made_by; }
  // Collapse c ended the faces [first_ended(c), first_ended(c + 1)).
  [[nodiscard]] FaceId first_ended(CollapseIndex c) const noexcept { return first_ended_[c]; }
  [[nodiscard]] std::span<const FaceId> made(CollapseIndex c) const noexcept {
    return {made_.data() + first_made_[c], first_made_[c + 1] - first_made_[c]};
  }

 private:
  void list_ended();
  void find_makers();

  const CollapseSequence& sequence_;
  std::vector<LevelFace> faces_;  // made_by holds places
  std::vector<FaceId> first_ended_;
  std::vector<std::uint32_t> first_made_;
  std::vector<FaceId> made_;
};

// Computes the distances of many points from one triangle, in single precision.

// Stores points with one array per coordinate, so that compilers vectorise the loops over them.
struct PointBatch {
  std::vector<float> x, y, z;

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
  void resize(std::size_t count);
  void set(std::size_t i, const glm::vec3& p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
};

class TriangleBatch {
 public:
  TriangleBatch(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

  // For every point whose squared distance is less than its entry in `least`, stores that distance there and `number`
  // in `chosen`.
  void choose_nearer(const PointBatch& points, std::uint32_t number, float* least, std::uint32_t* chosen) const;
  [[nodiscard]] float squared_distance(const glm::vec3& point) const;
  // One coordinate of four points.
  using Four = std::array<float, 4>;
  [[nodiscard]] Four squared_distances(const Four& x, const Four& y, const Four& z) const;
  // Returns the term to add to a distance so that it is an upper bound despite rounding.
  [[nodiscard]] float rounding(float distance) const { return 2e-6F * (distance + longest_edge_); }

 private:
  struct Edge {
    glm::vec3 start;    // relative to origin_
    glm::vec3 along;    // from start to end
    glm::vec3 inwards;  // in the plane, unit length; zero where the triangle has no numerically valid inside
    float inverse_squared_length = 0.0F;
    float offset = 0.0F;  // added to the distance from the line; negative where there is no inside
  };
  [[nodiscard]] float squared_distance(float x, float y, float z) const;

  glm::vec3 origin_;
  glm::vec3 normal_;
  std::array<Edge, 3> edges_;
  float longest_edge_ = 0.0F;
};

// Keeps one mesh of the sequence as the reference for measuring faces of coarser ones.

// Holds the faces that exist just before collapse `time`. Its vertices have their own numbers.
class ReferenceMesh {
 public:
  // `maker_errors` bounds, for each collapse before `time`, the distance of the faces that it made from the input.
  ReferenceMesh(std::span<const glm::vec3> positions, const LevelFaces& levels, CollapseIndex time,
                std::span<const float> maker_errors);

  [[nodiscard]] std::uint32_t vertex_count() const noexcept { return static_cast<std::uint32_t>(positions_.size()); }
  [[nodiscard]] std::uint32_t face_count() const noexcept { return static_cast<std::uint32_t>(faces_.size()); }
  [[nodiscard]] const glm::vec3& position(std::uint32_t v) const noexcept { return positions_[v]; }
  // Returns the number of an input vertex in this mesh; no_id when it no longer exists.
  [[nodiscard]] std::uint32_t vertex_of(VertexId v) const noexcept { return number_of_[v]; }
  [[nodiscard]] const Triangle& corners(std::uint32_t face) const noexcept { return faces_[face]; }
  [[nodiscard]] float error(std::uint32_t face) const noexcept { return errors_[face]; }
  [[nodiscard]] double mean_error() const noexcept { return mean_error_; }
  [[nodiscard]] std::span<const std::uint32_t> star(std::uint32_t v) const noexcept {
    return {stars_.data() + first_star_[v], first_star_[v + 1] - first_star_[v]};
  }
  // Bounding ball of a face.
  struct Ball {
    glm::vec3 center;
    float radius;
  };
  [[nodiscard]] const Ball& ball(std::uint32_t face) const noexcept { return balls_[face]; }

 private:
  void add_face(const Triangle& corners, std::span<const glm::vec3> positions);
  void link_stars();

  std::vector<std::uint32_t> number_of_;
  std::vector<glm::vec3> positions_;
  std::vector<Ball> balls_;
  std::vector<Triangle> faces_;
  std::vector<float> errors_;
  double mean_error_ = 0.0;
  std::vector<std::uint32_t> first_star_;
  std::vector<std::uint32_t> stars_;
};

// Bounds the distance of triangles from a mesh: an upper bound that holds for every point of them.

// Halves the triangle until every piece is near one face of the mesh. A face is convex, so the distance from it is a
// convex function: a piece is no farther from it than the farthest of the piece's corners. The mesh may have any
// topology.
class FaceDistance {
 public:
  explicit FaceDistance(const ReferenceMesh& mesh) : mesh_(mesh), is_taken_(mesh.face_count(), 0) {}

  // Bounds the distance of every point of the triangle from the input: the distance from a face of the mesh plus that
  // face's own error. Refined until it is at most `wanted` or nearly exact; infinite when it is not below `useful`. The
  // corners are vertices of the mesh.
  [[nodiscard]] float bound(const Triangle& corners, float wanted, float useful);

 private:
  using Piece = std::array<glm::vec3, 3>;
  struct NearFace {
    std::uint32_t face;      // index in the mesh
    std::uint32_t triangle;  // index into triangles_; no_id until it is needed
  };

  void gather(const Triangle& corners);
  void refine(const Piece& piece, std::size_t first);
  void halve(const Piece& piece, std::size_t first);
  void keep_close(const glm::vec3& center, float radius, std::size_t first, std::size_t end);
  [[nodiscard]] float measure(const Piece& piece, const glm::vec3& center, std::size_t first, std::size_t end);
  [[nodiscard]] const TriangleBatch& triangle_of(NearFace& near);
  [[nodiscard]] float enough() const;

  const ReferenceMesh& mesh_;
  std::vector<char> is_taken_;  // per face
  std::vector<std::uint32_t> taken_;
  std::vector<NearFace> near_;
  std::vector<TriangleBatch> triangles_;
  float widest_ = 0.0F;  // radius of the widest face in near_
  // State of the current triangle.
  float wanted_ = 0.0F, useful_ = 0.0F;
  float at_least_ = 0.0F;  // lower limit of every bound: the distance of some point of the triangle
  float bound_ = 0.0F;     // maximum over the pieces that are done
  std::size_t pieces_left_ = 0;
  // indices into near_, as a stack: those of a piece start at some index, followed by those of its parts
  std::vector<std::uint32_t> candidates_;
};

}  // namespace occlod
