// What refinement, occlusion and drawing need to know about a camera, computed once per view.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "occlod/math/bounds.h"
#include "occlod/view/camera.h"

namespace occlod {

// An immutable view in world space. Clip space is OpenGL's: x, y, z in [-w, w], z = -w on the near plane,
// w = distance from the eye plane, or 1 when orthographic. Pixel (0, 0) is the top left; its centre is (0.5, 0.5).
class View {
 public:
  // Throws Error when the camera is not finite, has no direction, or a size, angle or range that makes no image.
  explicit View(const Camera& camera);

  [[nodiscard]] const Camera& camera() const noexcept { return camera_; }
  [[nodiscard]] int width() const noexcept { return camera_.width; }
  [[nodiscard]] int height() const noexcept { return camera_.height; }
  [[nodiscard]] const glm::dmat4& world_to_clip() const noexcept { return world_to_clip_; }
  [[nodiscard]] const glm::dvec3& direction() const noexcept { return direction_; }  // unit, from the eye
  [[nodiscard]] bool is_orthographic() const noexcept { return camera_.orthographic_height.has_value(); }
  // Pixels that a unit length across the axis covers where w = 1: at distance 1 along it, or anywhere.
  [[nodiscard]] double focal_length_px() const noexcept { return focal_length_px_; }
  // The distance from the eye plane where depth images hold this nearness (see DepthBuffer), > 0.
  [[nodiscard]] double distance_at(double nearness) const noexcept {
    return is_orthographic() ? camera_.far - nearness * (camera_.far - camera_.near) : 1.0 / nearness;
  }
  // Pixels that a unit length across the axis covers there.
  [[nodiscard]] double scale_px_at(double nearness) const noexcept {
    return is_orthographic() ? focal_length_px_ : focal_length_px_ * nearness;
  }
  // Cosine of the angle between the axis and the rays to the corners of the image.
  [[nodiscard]] double cos_corner_angle() const noexcept { return cos_corner_angle_; }

 private:
  Camera camera_;
  glm::dmat4 world_to_clip_{1.0};
  glm::dvec3 direction_{0.0, 0.0, -1.0};
  double focal_length_px_ = 0.0;
  double cos_corner_angle_ = 1.0;
};

// A view seen from one object: the same questions, asked in the object's own space.
class ObjectView {
 public:
  // Throws Error when `object_to_world` is not finite, not affine or cannot be inverted, and when an orthographic view
  // shows what is 1e29 object units or more from the object.
  ObjectView(const View& view, const glm::dmat4& object_to_world);

  [[nodiscard]] const glm::mat4& object_to_clip() const noexcept { return object_to_clip_; }
  // Object space. Of an orthographic view a point 2^27 times as far away as anything that it shows, in the direction
  // that its rays come from: what turns away from there by more than eye_slack turns away from the direction.
  [[nodiscard]] const glm::vec3& eye() const noexcept { return eye_; }
  [[nodiscard]] bool is_orthographic() const noexcept { return orthographic_; }
  // True when the transform turns triangles inside out (negative determinant).
  [[nodiscard]] bool mirrored() const noexcept { return mirrored_; }
  // False only when no point of the sphere is inside the frustum.
  [[nodiscard]] bool may_be_inside(const Sphere& sphere) const noexcept;
  // The frustum planes, inward, unit normals, object space: left, right, bottom, top, near, far.
  [[nodiscard]] const std::array<glm::vec4, 6>& planes() const noexcept { return planes_; }
  // The largest number of pixels that a displacement of one object unit at any point of the sphere that is inside the
  // frustum can cover on the screen. Infinite when the eye of a perspective view may be inside the sphere.
  [[nodiscard]] float largest_scale_px(const Sphere& sphere) const noexcept;

  // What that is made of, for those who ask about many at once.
  [[nodiscard]] const glm::dmat4x3& object_to_eye() const noexcept { return object_to_eye_; }  // world units
  [[nodiscard]] const glm::dvec3& direction() const noexcept { return direction_; }   // of the view, world space
  [[nodiscard]] double largest_stretch() const noexcept { return largest_stretch_; }  // world units per object unit
  [[nodiscard]] double focal_length_px() const noexcept { return focal_length_px_; }
  [[nodiscard]] double cos_corner_angle() const noexcept { return cos_corner_angle_; }

 private:
  glm::mat4 object_to_clip_{1.0F};
  glm::dmat4x3 object_to_eye_{1.0};  // world units, relative to the eye
  std::array<glm::vec4, 6> planes_{};
  glm::vec3 eye_{0.0F};
  glm::dvec3 direction_{0.0, 0.0, -1.0};  // world space
  double largest_stretch_ = 1.0;          // world units per object unit
  double focal_length_px_ = 0.0;
  double cos_corner_angle_ = 1.0;
  bool mirrored_ = false;
  bool orthographic_ = false;
};

}  // namespace occlod
