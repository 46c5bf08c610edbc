// From object space to snapped pixel coordinates, a batch of triangles at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod::raster {

inline constexpr int subpixel_bits = 8;
inline constexpr int subpixels = 1 << subpixel_bits;  // per pixel
// Corners this far from the middle of the image or nearer are drawn as they are: at most 2^24 subpixels apart, so that
// products of two differences are exact in int64 and in double. Images have at most 2^14 pixels a side and are always
// inside.
inline constexpr double guard_band_px = 32768.0;

// A corner on the screen: subpixels from the top left, exact from here on.
struct ScreenVertex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  double nearness = 0.0;  // see DepthBuffer
};

// Added before truncation so that coordinates within the guard band are rounded as positive numbers.
inline constexpr double rounding_bias = 1 << 25;

// A multiple of the lanes of every vector.
inline constexpr std::size_t batch_triangles = 64;

// Corner k of triangle i is at [k][i].
template <class T>
using Corners = std::array<std::array<T, batch_triangles>, 3>;

// Loops over a batch may write up to the end of its arrays, whatever its size.
struct TriangleBatch {
  std::size_t size = 0;
  Corners<float> object_x, object_y, object_z;
  Corners<double> clip_x, clip_y, clip_z, clip_w;
  Corners<std::int32_t> x, y;  // subpixels; 0 where not drawable
  Corners<double> nearness;
  Corners<std::int32_t> drawable;  // 1 when finite, before the near plane and inside the guard band

  [[nodiscard]] glm::dvec4 clip_position(std::size_t corner, std::size_t i) const noexcept {
    return {clip_x[corner][i], clip_y[corner][i], clip_z[corner][i], clip_w[corner][i]};
  }
  [[nodiscard]] ScreenVertex screen_vertex(std::size_t corner, std::size_t i) const noexcept {
    return {x[corner][i], y[corner][i], nearness[corner][i]};
  }
};

class Projection {
 public:
  Projection(const glm::mat4& object_to_clip, int width, int height);

  // Fills the batch with one to batch_triangles triangles. The same bits with every instruction set.
  void project(std::span<const glm::vec3> positions, std::span<const Triangle> triangles, TriangleBatch& batch) const;
  // The same arithmetic for one corner that is before the near plane and inside the guard band.
  [[nodiscard]] ScreenVertex snap(const glm::dvec4& clip) const noexcept;
  [[nodiscard]] const glm::dmat4& to_clip() const noexcept { return to_clip_; }
  [[nodiscard]] const glm::dvec2& half_size() const noexcept { return half_size_; }  // subpixels
  // Of an affine matrix; see DepthBuffer.
  [[nodiscard]] bool is_orthographic() const noexcept { return orthographic_; }
  // |x| <= guard().x * w and |y| <= guard().y * w inside the guard band.
  [[nodiscard]] const glm::dvec2& guard() const noexcept { return guard_; }

 private:
  glm::dmat4 to_clip_;
  glm::dvec2 half_size_;  // subpixels
  glm::dvec2 guard_;
  bool orthographic_;
};

}  // namespace occlod::raster
