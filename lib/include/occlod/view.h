// Cameras as data, as scene files hold them and reports print them, and views: what refinement, occlusion and drawing
// need to know about a camera, computed once per view.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>

#include "occlod/bounds.h"

namespace occlod {

// A right-handed camera at `eye` that looks at `target`, in perspective unless it has an orthographic height. All
// lengths are in world units; pixels are square.
struct Camera {
  glm::dvec3 eye{0.0, 0.0, 3.0};  // world space
  glm::dvec3 target{0.0};         // world space, not the eye
  glm::dvec3 up{0.0, 1.0, 0.0};   // any length, not along the line of sight
  double fov_y_deg = 45.0;        // full vertical angle, in (0, 180); an orthographic camera ignores it
  int width = 1024;               // pixels, 1 to 16,384
  int height = 768;               // pixels, 1 to 16,384
  double near = 0.01;             // distance to the near plane, > 0
  double far = 100.0;             // distance to the far plane, > near
  // World units from the lower to the upper border of the image, > 0. When set, all rays are parallel to the line of
  // sight.
  std::optional<double> orthographic_height = std::nullopt;
  // Where the line of sight meets the image, from -1 at its left and lower border to 1 at its right and upper one, or
  // beyond: not 0 in stereo, in tiles of larger images and after a shift of the lens. In perspective only: an
  // orthographic camera is moved instead.
  glm::dvec2 principal_point{0.0};

  friend bool operator==(const Camera&, const Camera&) = default;
};

// Returns the distance (world units) at which a sphere of this radius (world units) in the middle of the image is seen
// whole, with a fiftieth to spare. An orthographic camera is treated as if it were in perspective, and the line of
// sight as if it met the middle.
[[nodiscard]] double fitting_distance(const Camera& camera, double radius);

// Returns the camera moved to where it sees a whole sphere or box, from ahead, a little from above and from the right:
// its target is the centre, the planes near and far enclose it. World units; a radius of 0 counts as the smallest.
[[nodiscard]] Camera looking_at(const glm::dvec3& center, double radius, Camera camera = {});
// Returns looking_at() the sphere around the box.
[[nodiscard]] Camera looking_at(const Box& box, const Camera& camera = {});

// Returns the same camera with parallel rays; at the distance of its target it shows as much.
[[nodiscard]] Camera orthographic(const Camera& camera);

// An immutable view in world space. Clip space is OpenGL's: x, y, z in [-w, w], z = -w on the near plane,
// w = distance from the eye plane, or 1 when orthographic. Pixel (0, 0) is the top left; its centre is (0.5, 0.5).
class View {
 public:
  // Throws Error that names the camera's field when it is not finite, has no direction, or has a size, angle or range
  // that makes no image.
  explicit View(const Camera& camera);

  // Returns the camera as given.
  [[nodiscard]] const Camera& camera() const noexcept { return camera_; }
  // Returns the width of the image, pixels.
  [[nodiscard]] int width() const noexcept { return camera_.width; }
  // Returns the height of the image, pixels.
  [[nodiscard]] int height() const noexcept { return camera_.height; }
  // Transforms world space to OpenGL clip space.
  [[nodiscard]] const glm::dmat4& world_to_clip() const noexcept { return world_to_clip_; }
  // Returns the direction of the line of sight from the eye, unit length, world space.
  [[nodiscard]] const glm::dvec3& direction() const noexcept { return direction_; }
  // True when all rays are parallel.
  [[nodiscard]] bool is_orthographic() const noexcept { return camera_.orthographic_height.has_value(); }
  // Returns the pixels that one world unit across the line of sight covers where w = 1: at distance 1 in perspective,
  // anywhere when orthographic.
  [[nodiscard]] double focal_length_px() const noexcept { return focal_length_px_; }
  // Returns the distance from the eye plane (world units) at which depth images hold this nearness > 0; see
  // DepthBuffer.
  [[nodiscard]] double distance_at(double nearness) const noexcept {
    return is_orthographic() ? camera_.far - nearness * (camera_.far - camera_.near) : 1.0 / nearness;
  }
  // Returns the pixels that one world unit across the line of sight covers at this nearness > 0.
  [[nodiscard]] double scale_px_at(double nearness) const noexcept {
    return is_orthographic() ? focal_length_px_ : focal_length_px_ * nearness;
  }
  // Returns the cosine of the largest angle between the line of sight and the rays to the corners of the image.
  [[nodiscard]] double cos_corner_angle() const noexcept { return cos_corner_angle_; }

 private:
  void project();

  Camera camera_;
  glm::dmat4 world_to_clip_{1.0};
  glm::dvec3 direction_{0.0, 0.0, -1.0};
  double focal_length_px_ = 0.0;
  double cos_corner_angle_ = 1.0;
};

// What z / w is on the near and on the far plane.
enum class ClipDepth {
  minus_one_to_one,  // OpenGL
  zero_to_one,       // Vulkan, Direct3D, Metal, WebGPU
  one_to_zero,       // the same reversed
};

// Without a far plane, a View has one at so many times the distance of the near one.
inline constexpr double infinite_far_ratio = 1e12;

// Returns the view of a program that has matrices: `world_to_eye`, a rigid motion, mirrored or not, and `eye_to_clip`,
// a perspective projection, off-centre or not, with a far plane or none, or an orthographic one. Both multiply columns
// from the left. width and height are those of the image in pixels, 1 to 16,384. The view shows what they show, pixel
// for pixel, also where clip space has y down (Vulkan); of a left-handed world it shows the image upside down. Its own
// clip space is that of View in any case. An orthographic view whose near plane is not before its eye gets an eye
// farther back. Throws Error for matrices that are not finite or none of these, for pixels that are not square (by more
// than 1e-5 of their size), and when near and far are not as `depth` says. O(1).
[[nodiscard]] View view_of(const glm::dmat4& world_to_eye, const glm::dmat4& eye_to_clip, int width, int height,
                           ClipDepth depth = ClipDepth::minus_one_to_one);

// A view in the space of one object. Immutable.
class ObjectView {
 public:
  // Throws Error when `object_to_world` is not finite, not affine or cannot be inverted, or when something that an
  // orthographic view shows is 1e29 object units or more from the object.
  ObjectView(const View& view, const glm::dmat4& object_to_world);

  // Transforms object space to OpenGL clip space.
  [[nodiscard]] const glm::mat4& object_to_clip() const noexcept { return object_to_clip_; }
  // Returns the eye in object space. For an orthographic view it is a point 2^27 times as far away as anything that the
  // view shows, in the direction from which its rays come: what faces away from this point faces away from the rays, up
  // to rounding.
  [[nodiscard]] const glm::vec3& eye() const noexcept { return eye_; }
  // True when all rays are parallel.
  [[nodiscard]] bool is_orthographic() const noexcept { return orthographic_; }
  // True when the transform turns triangles inside out, because its determinant is negative.
  [[nodiscard]] bool mirrored() const noexcept { return mirrored_; }
  // False only when no point of the sphere (object space) is inside the frustum. Conservative.
  [[nodiscard]] bool may_be_inside(const Sphere& sphere) const noexcept;
  // Returns the frustum planes in object space, with unit normals that point inwards: left, right, bottom, top, near,
  // far. A point p is inside when dot(plane.xyz, p) + plane.w >= 0 for all of them.
  [[nodiscard]] const std::array<glm::vec4, 6>& planes() const noexcept { return planes_; }
  // Returns an upper bound on the pixels that a displacement of one object unit can cover on the screen, at any point
  // of the sphere (object space) inside the frustum. Infinite when the eye of a perspective view may be inside the
  // sphere.
  [[nodiscard]] float largest_scale_px(const Sphere& sphere) const noexcept;

  // Transforms object space to world space relative to the eye. This function and the next four give the parts of
  // largest_scale_px(), to compute it for many spheres at once.
  [[nodiscard]] const glm::dmat4x3& object_to_eye() const noexcept { return object_to_eye_; }
  // Returns the line of sight of the view, unit length, world space.
  [[nodiscard]] const glm::dvec3& direction() const noexcept { return direction_; }
  // Returns the world units per object unit in the direction in which the transform stretches most.
  [[nodiscard]] double largest_stretch() const noexcept { return largest_stretch_; }
  // Returns View::focal_length_px() of the view.
  [[nodiscard]] double focal_length_px() const noexcept { return focal_length_px_; }
  // Returns View::cos_corner_angle() of the view.
  [[nodiscard]] double cos_corner_angle() const noexcept { return cos_corner_angle_; }

 private:
  glm::mat4 object_to_clip_{1.0F};
  glm::dmat4x3 object_to_eye_{1.0};  // to world units relative to the eye
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
