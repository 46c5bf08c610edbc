#include "occlod/view.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "base/arithmetic.h"
#include "base/placement.h"
#include "occlod/base.h"

namespace occlod {

// The sphere must fit the smaller side of the image.
double fitting_distance(const Camera& camera, double radius) {
  const double half_y = glm::radians(camera.fov_y_deg) / 2.0;
  const double half = std::atan(std::tan(half_y) * std::min(1.0, static_cast<double>(camera.width) / camera.height));
  return 1.02 * radius / std::sin(half);
}

Camera looking_at(const glm::dvec3& center, double radius, Camera camera) {
  radius = std::max(radius, static_cast<double>(std::numeric_limits<float>::min()));
  const double distance = fitting_distance(camera, radius);
  camera.target = center;
  camera.eye = center + distance * glm::normalize(glm::dvec3(1.0, 1.0, 2.0));
  camera.near = (distance - radius) / 2.0;
  camera.far = distance + 2.0 * radius;
  return camera;
}

Camera looking_at(const Box& box, const Camera& camera) {
  const glm::dvec3 low(box.min), high(box.max);
  return looking_at((low + high) / 2.0, glm::distance(low, high) / 2.0, camera);
}

Camera orthographic(const Camera& camera) {
  Camera result = camera;
  const double half_tangent = std::tan(glm::radians(camera.fov_y_deg) / 2.0);
  result.orthographic_height = 2.0 * glm::distance(camera.eye, camera.target) * half_tangent;
  if (camera.principal_point == glm::dvec2(0.0)) return result;
  const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up)), up = glm::cross(right, forward);
  const double half = *result.orthographic_height / 2.0;
  const glm::dvec3 to_middle =
      -half * (camera.principal_point.x * camera.width / camera.height * right + camera.principal_point.y * up);
  result.eye += to_middle;
  result.target += to_middle;
  result.principal_point = glm::dvec2(0.0);
  return result;
}

namespace {

bool finite(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(m[column][row])) return false;
  return true;
}

// Returns a * b - c * d to 1.5 units in the last place (Kahan; Jeannerod, Louvet & Muller 2013): std::fma rounds once.
double difference_of_products(double a, double b, double c, double d) noexcept {
  const double cd = c * d;
  return std::fma(a, b, -cd) - std::fma(c, d, -cd);
}

glm::dvec3 accurate_cross(const glm::dvec3& a, const glm::dvec3& b) noexcept {
  return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
          difference_of_products(a.x, b.y, a.y, b.x)};
}

}  // namespace

double stretch_of(const glm::dmat3& m) {
  const glm::dmat3 square = glm::transpose(m) * m;
  double largest = 0.0;
  for (int column = 0; column < 3; ++column) {
    const glm::dvec3 c = glm::abs(square[column]);
    largest = std::max(largest, c.x + c.y + c.z);
  }
  return std::sqrt(largest);
}

double determinant_of(const glm::dmat3& m) { return glm::dot(m[0], accurate_cross(m[1], m[2])); }

glm::dvec3 solve(const glm::dmat3& m, const glm::dvec3& y) {
  const glm::dvec3 yz = accurate_cross(m[1], m[2]), zx = accurate_cross(m[2], m[0]), xy = accurate_cross(m[0], m[1]);
  return glm::dvec3(glm::dot(yz, y), glm::dot(zx, y), glm::dot(xy, y)) / determinant_of(m);
}

void require_placement(const glm::dmat4& object_to_world) {
  const double determinant = determinant_of(glm::dmat3(object_to_world));
  if (!finite(object_to_world) || glm::row(object_to_world, 3) != glm::dvec4(0, 0, 0, 1) ||
      !std::isfinite(determinant) || determinant == 0.0)
    throw Error({"object", "transform", "is not an affine matrix with an inverse",
                 "give finite numbers, last row 0 0 0 1, and no zero scale"});
}

namespace {

// Returns a plane for dot products with points in object space. `normal` and `offset` are in world space relative to
// the eye. The plane is moved outwards by the possible rounding error of sums in double precision.
glm::vec4 unit_plane(const glm::dvec3& normal, double offset, const glm::dmat4x3& object_to_eye) {
  const glm::dvec3 in_object = normal * glm::dmat3(object_to_eye);
  const glm::dvec3 terms = normal * object_to_eye[3];
  const double rounding = 1e-15 * (std::abs(terms.x) + std::abs(terms.y) + std::abs(terms.z) + std::abs(offset));
  return glm::vec4(glm::dvec4(in_object, terms.x + terms.y + terms.z + offset + rounding) / glm::length(in_object));
}

// Computes the planes from the axes of the view and not, as is usual, from sums of rows of world_to_clip: where the far
// plane is 1e9 times as far away as the near one, or the eye is far from the origin, such a sum is mostly rounding
// error.
std::array<glm::vec4, 6> frustum_planes(const View& view, const glm::dmat4x3& object_to_eye) {
  const glm::dvec3 across(glm::row(view.world_to_clip(), 0)), along(glm::row(view.world_to_clip(), 1));
  const glm::dvec3& ahead = view.direction();
  // w relative to the eye is w_per_unit * (distance along the axis) + w_at_eye.
  const glm::dvec3 w_per_unit = view.is_orthographic() ? glm::dvec3(0.0) : ahead;
  const double w_at_eye = view.is_orthographic() ? 1.0 : 0.0;
  const auto plane = [&](const glm::dvec3& normal, double offset) { return unit_plane(normal, offset, object_to_eye); };
  return {plane(w_per_unit + across, w_at_eye), plane(w_per_unit - across, w_at_eye),
          plane(w_per_unit + along, w_at_eye),  plane(w_per_unit - along, w_at_eye),
          plane(ahead, -view.camera().near),    plane(-ahead, view.camera().far)};
}

// Returns a bound on the distance from the object's origin of anything that the view shows, in object space, rounded up
// to a power of two. It is at least the smallest normal float, so that a multiple of it has all digits.
double shown_reach(const View& view, const glm::dmat3& linear, const glm::dvec3& eye) {
  const Camera& camera = view.camera();
  const glm::dvec2 half = glm::dvec2(camera.width, camera.height) / (2.0 * view.focal_length_px());
  const glm::dvec3 axes[] = {solve(linear, glm::dvec3(1, 0, 0)), solve(linear, glm::dvec3(0, 1, 0)),
                             solve(linear, glm::dvec3(0, 0, 1))};
  const double largest = std::max({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
  const double reach = glm::length(eye) + 2.0 * largest * (glm::length(half) + camera.far);
  return std::exp2(std::ceil(std::log2(std::max(reach, 0x1p-126))));
}

// Returns a point e that stands in for the eye of an orthographic view: a normal n faces away from all rays iff dot(n,
// -e) > 0. For a sphere with centre c and radius r, faces_away() tests dot(n, c - e) > r + slack, and where the sphere
// touches what is shown, |c| is at most reach + r. The slack is 1.2e-7 of the largest coordinate of e, of which the
// rounding of e takes at most sqrt(3) * 2^-24; the remainder is more than the reach.
glm::dvec3 far_eye(const View& view, const glm::dmat3& linear, const glm::dvec3& eye) {
  constexpr double times_as_far = 1 << 27;
  return shown_reach(view, linear, eye) * times_as_far * glm::normalize(solve(linear, -view.direction()));
}

}  // namespace

ObjectView::ObjectView(const View& view, const glm::dmat4& object_to_world) {
  require_placement(object_to_world);
  const glm::dmat3 linear(object_to_world);
  object_to_clip_ = glm::mat4(view.world_to_clip() * object_to_world);
  // Far from the origin the difference of two positions is rounded only once, and little; positions multiplied by a
  // matrix lose more digits.
  object_to_eye_ = glm::dmat4x3(object_to_world);
  object_to_eye_[3] -= view.camera().eye;
  orthographic_ = view.is_orthographic();
  const glm::dvec3 eye = solve(linear, -object_to_eye_[3]);
  eye_ = glm::vec3(orthographic_ ? far_eye(view, linear, eye) : eye);
  if (orthographic_ && !std::isfinite(largest_coordinate(eye_)))
    throw Error({"camera", "orthographic_height, far", "reach too far from the object for single precision",
                 "stay within 1e29 object units"});
  direction_ = view.direction();
  largest_stretch_ = stretch_of(linear);
  focal_length_px_ = view.focal_length_px();
  cos_corner_angle_ = view.cos_corner_angle();
  mirrored_ = determinant_of(linear) < 0.0;
  planes_ = frustum_planes(view, object_to_eye_);
}

bool ObjectView::may_be_inside(const Sphere& sphere) const noexcept {
  return std::all_of(planes_.begin(), planes_.end(), [&](const glm::vec4& plane) {
    const glm::vec3 terms = glm::vec3(plane) * sphere.center;
    const float slack =
        1e-6F * (std::abs(terms.x) + std::abs(terms.y) + std::abs(terms.z) + std::abs(plane.w) + sphere.radius);
    // The comparison is negated so that NaN counts as inside.
    return !(terms.x + terms.y + terms.z + plane.w < -(sphere.radius + slack));
  });
}

// Uses double precision: the centre may be far from the object's origin and near the eye, and squares of tiny or huge
// lengths leave the range of floats.
float ObjectView::largest_scale_px(const Sphere& sphere) const noexcept {
  if (orthographic_) return rounded_up(focal_length_px_ * largest_stretch_);
  const glm::dvec3 center = object_to_eye_ * glm::dvec4(sphere.center, 1.0);
  const double radius = static_cast<double>(sphere.radius) * largest_stretch_;
  const double distance = glm::length(center);
  const double nearest = distance - radius;
  if (!(nearest > 0.0)) return std::numeric_limits<float>::infinity();
  // A displacement at distance d and at angle a from the axis covers at most f / (d cos^2 a) pixels per unit: f / z for
  // the depth z = d cos a, and another factor 1 / cos a in the radial direction. The largest angle is the angle of the
  // centre plus the angular radius of the sphere, at most the angle of the image's corners.
  const double cos_center = std::clamp(glm::dot(center, direction_) / distance, -1.0, 1.0);
  const double sin_center = std::sqrt(1.0 - cos_center * cos_center);
  const double sin_radius = radius / distance;
  const double cos_radius = std::sqrt(1.0 - sin_radius * sin_radius);
  const double cos_largest = std::max(cos_corner_angle_, cos_center * cos_radius - sin_center * sin_radius);
  return rounded_up(focal_length_px_ * largest_stretch_ / (nearest * cos_largest * cos_largest));
}

namespace {

[[noreturn]] void refuse(const char* place, const char* problem, const char* remedy) {
  throw Error({"camera", place, problem, remedy});
}

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check(const Camera& camera) {
  if (!finite(camera.eye)) refuse("eye", "is not finite", "give three numbers");
  if (!finite(camera.target)) refuse("target", "is not finite", "give three numbers");
  if (!finite(camera.up)) refuse("up", "is not finite", "give three numbers");
  const glm::dvec3 forward = camera.target - camera.eye;
  if (!(glm::length(forward) > 0.0)) refuse("target", "is where the eye is", "move one of them");
  if (!(glm::length(glm::cross(glm::normalize(forward), camera.up)) > 1e-9 * glm::length(camera.up)))
    refuse("up", "points along the line of sight or is zero", "choose another up direction");
  if (!(camera.fov_y_deg > 0.0 && camera.fov_y_deg < 180.0))
    refuse("fov_y_deg", "is not between 0 and 180", "give the full vertical angle in degrees");
  if (camera.width < 1 || camera.height < 1 || camera.width > 16384 || camera.height > 16384)
    refuse("size", "is not between 1x1 and 16384x16384 pixels", "give another size");
  if (camera.orthographic_height && !(*camera.orthographic_height > 0.0 && std::isfinite(*camera.orthographic_height)))
    refuse("orthographic_height", "is not a length above 0", "give what the image shows from bottom to top");
  const glm::dvec2& principal = camera.principal_point;
  if (!std::isfinite(principal.x) || !std::isfinite(principal.y))
    refuse("principal_point", "is not finite", "give two numbers");
  if (camera.orthographic_height && principal != glm::dvec2(0.0))
    refuse("principal_point", "is not 0, and the camera is orthographic", "move the camera instead");
  if (!(camera.near > 0.0 && camera.far > camera.near && std::isfinite(camera.far)))
    refuse("near, far", "are not 0 < near < far", "give other distances");
}

}  // namespace

View::View(const Camera& camera) : camera_(camera) {
  check(camera);
  direction_ = glm::normalize(camera.target - camera.eye);
  project();
  // Extreme distances and angles overflow to infinity.
  bool is_finite = std::isfinite(focal_length_px_);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) is_finite = is_finite && std::isfinite(world_to_clip_[column][row]);
  if (!is_finite) refuse("", "has distances or an angle that double precision cannot hold", "choose moderate ones");
}

void View::project() {
  const Camera& camera = camera_;
  const double aspect = static_cast<double>(camera.width) / camera.height;
  if (camera.orthographic_height) {
    const double half = *camera.orthographic_height / 2.0;
    world_to_clip_ = glm::ortho(-half * aspect, half * aspect, -half, half, camera.near, camera.far) *
                     glm::lookAt(camera.eye, camera.target, camera.up);
    focal_length_px_ = camera.height / *camera.orthographic_height;
    return;
  }
  const double half_angle = glm::radians(camera.fov_y_deg) / 2.0;
  glm::dmat4 eye_to_clip = glm::perspective(2.0 * half_angle, aspect, camera.near, camera.far);
  eye_to_clip[2].x -= camera.principal_point.x;
  eye_to_clip[2].y -= camera.principal_point.y;
  world_to_clip_ = eye_to_clip * glm::lookAt(camera.eye, camera.target, camera.up);
  focal_length_px_ = camera.height / 2.0 / std::tan(half_angle);
  const glm::dvec2 corner = glm::dvec2(aspect, 1.0) * std::tan(half_angle) * (1.0 + glm::abs(camera.principal_point));
  cos_corner_angle_ = 1.0 / std::sqrt(1.0 + glm::dot(corner, corner));
}

namespace {

[[noreturn]] void refuse_matrix(const char* matrix, const char* problem, const char* remedy) {
  throw Error({"view", matrix, problem, remedy});
}

constexpr double matrix_slack = 1e-5;  // matrices may be single-precision, and products of such

// What a projection does to eye space. Clip x is x.scale times eye x, plus x.offset times w; likewise y.
struct Lens {
  struct Axis {
    double scale, offset;
  };
  Axis x, y;
  double z_scale, z_offset;  // clip z is z_scale times eye z, plus z_offset
  double w_scale, w_offset;  // w is w_scale times eye z, plus w_offset: +-1 and 0 in perspective, else 0 and 1
};

Lens lens_of(const glm::dmat4& eye_to_clip) {
  const char* const remedy = "give a perspective or an orthographic projection";
  const glm::dvec4 w = glm::row(eye_to_clip, 3);
  const bool is_perspective = w.z != 0.0 && w.w == 0.0, is_orthographic = w.z == 0.0 && w.w > 0.0;
  if (w.x != 0.0 || w.y != 0.0 || !(is_perspective || is_orthographic))
    refuse_matrix("eye_to_clip", "has a last row that is no view's", remedy);
  const double unit = is_perspective ? std::abs(w.z) : w.w;
  const glm::dvec4 x = glm::row(eye_to_clip, 0) / unit, y = glm::row(eye_to_clip, 1) / unit;
  const glm::dvec4 z = glm::row(eye_to_clip, 2) / unit;
  const double w_scale = w.z / unit;
  const glm::dvec2 with_w = is_perspective ? w_scale * glm::dvec2(x.z, y.z) : glm::dvec2(x.w, y.w);
  const glm::dvec2 without_w = is_perspective ? glm::dvec2(x.w, y.w) : glm::dvec2(x.z, y.z);
  if (x.x == 0.0 || y.y == 0.0 || x.y != 0.0 || y.x != 0.0 || without_w != glm::dvec2(0.0))
    refuse_matrix("eye_to_clip", "turns, shears or flattens the image", remedy);
  if (z.x != 0.0 || z.y != 0.0)
    refuse_matrix("eye_to_clip", "has an oblique near plane", "give the projection as it was before");
  return {{x.x, with_w.x}, {y.y, with_w.y}, z.z, z.w, w_scale, w.w / unit};
}

// Returns the eye z where clip z is `depth` times w. Infinite or not a number if that is nowhere.
double plane_at(const Lens& lens, double depth) {
  return (depth * lens.w_offset - lens.z_offset) / (lens.z_scale - depth * lens.w_scale);
}

void require_rigid(const glm::dmat4& world_to_eye) {
  bool is_rigid = finite(world_to_eye) && glm::row(world_to_eye, 3) == glm::dvec4(0, 0, 0, 1);
  const glm::dmat3 square = glm::transpose(glm::dmat3(world_to_eye)) * glm::dmat3(world_to_eye);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) is_rigid = is_rigid && std::abs(square[i][k] - (i == k ? 1.0 : 0.0)) <= matrix_slack;
  if (!is_rigid)
    refuse_matrix("world_to_eye", "is no rigid motion", "give a rotation and a translation, without scale");
}

}  // namespace

View view_of(const glm::dmat4& world_to_eye, const glm::dmat4& eye_to_clip, int width, int height, ClipDepth depth) {
  require_rigid(world_to_eye);
  if (!finite(eye_to_clip)) refuse_matrix("eye_to_clip", "is not finite", "give 16 numbers");
  Lens lens = lens_of(eye_to_clip);
  const bool is_orthographic = lens.w_scale == 0.0;
  const double z_near = plane_at(lens, depth == ClipDepth::minus_one_to_one ? -1.0
                                       : depth == ClipDepth::zero_to_one    ? 0.0
                                                                            : 1.0);
  const double z_far = plane_at(lens, depth == ClipDepth::one_to_zero ? 0.0 : 1.0);
  const double ahead = is_orthographic ? std::copysign(1.0, z_far - z_near) : lens.w_scale;

  const glm::dmat3 turn(world_to_eye);
  const glm::dvec3 forward = ahead * glm::normalize(glm::row(turn, 2));
  const glm::dvec3 right = std::copysign(1.0, lens.x.scale) * glm::normalize(glm::row(turn, 0));
  glm::dvec3 up = std::copysign(1.0, lens.y.scale) * glm::normalize(glm::row(turn, 1));
  if (glm::dot(glm::cross(right, up), forward) > 0.0) {  // clip space has y down, or the world is left-handed
    up = -up;
    lens.y.offset = -lens.y.offset;
  }
  lens.x.scale = std::abs(lens.x.scale);
  lens.y.scale = std::abs(lens.y.scale);

  Camera camera;
  camera.eye = solve(turn, -glm::dvec3(world_to_eye[3]));
  camera.up = up;
  camera.width = width;
  camera.height = height;
  camera.near = ahead * z_near;
  camera.far = ahead * z_far;
  if (is_orthographic) {
    camera.orthographic_height = 2.0 / lens.y.scale;
    camera.eye -= lens.x.offset / lens.x.scale * right + lens.y.offset / lens.y.scale * up;
    const double range = camera.far - camera.near, back = camera.near > 0.0 ? 0.0 : range - camera.near;
    camera.eye -= back * forward;
    camera.near += back;
    camera.far += back;
  } else {
    camera.fov_y_deg = glm::degrees(2.0 * std::atan(1.0 / lens.y.scale));
    camera.principal_point = {lens.x.offset, lens.y.offset};
    // Infinite, or beyond that, as where a projection leaves room for rounding.
    const bool is_beyond = camera.far < 0.0 && camera.far < -1e5 * camera.near;
    if (is_beyond || camera.far > infinite_far_ratio * camera.near) camera.far = infinite_far_ratio * camera.near;
  }
  if (!(camera.near > 0.0 && camera.far > camera.near))
    refuse_matrix("eye_to_clip", "has no near plane before its far plane", "name the ClipDepth that it is made for");
  // As far away as makes the direction exact to the last digits.
  camera.target = camera.eye + std::max(1.0, glm::length(camera.eye)) * forward;
  check(camera);
  const double ratio = lens.x.scale * width / (lens.y.scale * height);
  if (!(std::abs(ratio - 1.0) <= matrix_slack))
    refuse_matrix("eye_to_clip", "makes pixels that are not square", "give the size of the image that it is made for");
  return View(camera);
}

}  // namespace occlod
