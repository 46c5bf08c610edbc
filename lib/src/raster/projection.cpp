#include "raster/projection.h"

#include <cassert>
#include <cmath>

namespace occlod::raster {
namespace {

// Rounds to the nearest integer, halves up. The bias makes the operand positive, where truncation is floor and has a
// SIMD instruction. |value| <= 2^24.
inline std::int32_t round_subpixel(double value) {
  constexpr std::int32_t bias = 1 << 25;
  return static_cast<std::int32_t>(value + (bias + 0.5)) - bias;
}

}  // namespace

Projection::Projection(const glm::mat4& object_to_clip, int width, int height)
    : to_clip_(object_to_clip),
      half_size_(glm::dvec2(width, height) * (subpixels / 2.0)),
      guard_(guard_band_px * subpixels / half_size_) {}

void Projection::project(std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                         TriangleBatch& batch) const {
  assert(triangles.size() <= batch_triangles);
  batch.size = triangles.size();
  std::array<glm::vec3, batch_triangles> points;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    for (std::size_t i = 0; i < triangles.size(); ++i) points[i] = positions[triangles[i][static_cast<int>(corner)]];
    project_corners(corner, points, batch);
  }
}

void Projection::project_corners(std::size_t corner, const std::array<glm::vec3, batch_triangles>& points,
                                 TriangleBatch& batch) const {
  const glm::dmat4& m = to_clip_;
  const glm::dvec2 half = half_size_;
  const glm::dvec2 guard = guard_;
  double* clip_x = batch.clip_x[corner].data();
  double* clip_y = batch.clip_y[corner].data();
  double* clip_z = batch.clip_z[corner].data();
  double* clip_w = batch.clip_w[corner].data();
  for (std::size_t i = 0; i < batch.size; ++i) {
    const double px = points[i].x, py = points[i].y, pz = points[i].z;
    clip_x[i] = m[0][0] * px + m[1][0] * py + m[2][0] * pz + m[3][0];
    clip_y[i] = m[0][1] * px + m[1][1] * py + m[2][1] * pz + m[3][1];
    clip_z[i] = m[0][2] * px + m[1][2] * py + m[2][2] * pz + m[3][2];
    clip_w[i] = m[0][3] * px + m[1][3] * py + m[2][3] * pz + m[3][3];
  }
  double* inverse_w = batch.inverse_w[corner].data();
  std::int32_t* drawable = batch.drawable[corner].data();
  std::int32_t* x = batch.x[corner].data();
  std::int32_t* y = batch.y[corner].data();
  for (std::size_t i = 0; i < batch.size; ++i) {
    const double w = clip_w[i];
    // False for NaN. An infinite x, y or w fails a comparison; an infinite z with a finite w cannot come from finite
    // positions.
    // Without branches, for SIMD.
    const int inside = int{w > 0.0} & int{w < 1e300} & int{clip_z[i] >= -w} & int{std::abs(clip_x[i]) <= guard.x * w} &
                       int{std::abs(clip_y[i]) <= guard.y * w};
    inverse_w[i] = 1.0 / w;
    drawable[i] = inside;
    x[i] = round_subpixel(inside != 0 ? half.x + clip_x[i] * inverse_w[i] * half.x : 0.0);
    y[i] = round_subpixel(inside != 0 ? half.y - clip_y[i] * inverse_w[i] * half.y : 0.0);
  }
}

ScreenVertex Projection::snap(const glm::dvec4& clip) const noexcept {
  const double inverse_w = 1.0 / clip.w;
  return {round_subpixel(half_size_.x + clip.x * inverse_w * half_size_.x),
          round_subpixel(half_size_.y - clip.y * inverse_w * half_size_.y), inverse_w};
}

}  // namespace occlod::raster
