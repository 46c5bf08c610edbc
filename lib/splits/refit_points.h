// Finds the faces around a vertex over which points lie, many points at a time.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

namespace occlod {

// The plane of a face at the vertex: the weights of the face's second and third corners and the height at a point, as
// linear functions of the point relative to the vertex.
struct FacePlane {
  glm::vec3 normal{0.0F}, along_y{0.0F}, along_z{0.0F};
  float corner_y = 0.0F, corner_z = 0.0F;  // the weights at the vertex: 1 for the corner that it is
};

// Sums over the points above a face: of squared and mixed weights of its corners, and of weighted heights.
struct FaceSums {
  std::array<double, 6> squares{};  // xx, xy, xz, yy, yz, zz
  std::array<double, 3> heights{};

  void add(const FaceSums& other) {
    for (std::size_t k = 0; k < squares.size(); ++k) squares[k] += other.squares[k];
    for (std::size_t k = 0; k < heights.size(); ++k) heights[k] += other.heights[k];
  }
};

// Points of a surface, relative to the vertex. Each coordinate has its own array, so that loops vectorize.
class RefitPoints {
 public:
  static constexpr std::size_t capacity = 64;
  using Row = std::array<float, capacity>;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  // Adds a point where the surface has this normal, of any length, and which stands for this share of it. Precondition:
  // there is room.
  void add(const glm::vec3& point, const glm::vec3& normal, float share) {
    constexpr float least_cosine = 0.7F;  // so that points beside a crease go to their own side of it
    rows_.x[size_] = point.x, rows_.y[size_] = point.y, rows_.z[size_] = point.z;
    rows_.normal_x[size_] = normal.x, rows_.normal_y[size_] = normal.y, rows_.normal_z[size_] = normal.z;
    rows_.least[size_] = least_cosine * std::sqrt(glm::dot(normal, normal));
    rows_.share[size_++] = share;
  }
  // Adds each point to the sums of the nearest face over which it lies, if there is one, and removes all points. One
  // sum for each face. The bits are the same with every instruction set.
  void settle(std::span<const FacePlane> faces, std::span<FaceSums> sums);

  struct Rows {
    alignas(64) Row x, y, z;
    alignas(64) Row normal_x, normal_y, normal_z, least;  // least product of the normal and that of its face
    alignas(64) Row share;
    alignas(64) Row face, weight_y, weight_z, height;  // set by settle(); face: the index, or -1
  };

 private:
  Rows rows_{};
  std::size_t size_ = 0;
};

}  // namespace occlod
