#include "refine/front.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "base/arithmetic.h"
#include "splits/star.h"

namespace occlod {
namespace {

// Returns the rotation from world space to the axes of the camera.
glm::dmat3 axes_of(const View& view) {
  const glm::dvec3 right = glm::normalize(glm::cross(view.direction(), view.camera().up));
  return glm::transpose(glm::dmat3(right, glm::cross(right, view.direction()), view.direction()));
}

// Returns whether two cameras have the same lens but for rounding, because cameras of a path are interpolated.
bool have_one_lens(const Camera& a, const Camera& b) {
  const auto alike = [](double x, double y) { return std::abs(x - y) <= 1e-13 * x; };
  return !a.orthographic_height && !b.orthographic_height && a.width == b.width && a.height == b.height &&
         a.principal_point == b.principal_point && alike(a.fov_y_deg, b.fov_y_deg) && alike(a.near, b.near) &&
         alike(a.far, b.far);
}

// Returns whether m stretches all directions by `stretch`, its largest singular value: then all columns are equally
// long and at right angles.
bool is_uniform(const glm::dmat3& m, double stretch) {
  const glm::dmat3 square = glm::transpose(m) * m;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(square[i][k] - (i == k ? stretch * stretch : 0.0)) <= 1e-9 * stretch * stretch)) return false;
  return true;
}

}  // namespace

std::optional<ViewMotion> motion_between(const PlacedView& from, const PlacedView& to, const glm::vec3& center) {
  const bool is_turned = glm::dmat3(from.object.object_to_eye()) != glm::dmat3(to.object.object_to_eye());
  if (!is_turned && from.view.camera() == to.view.camera() && from.object.object_to_eye() == to.object.object_to_eye())
    return ViewMotion{};
  if (!have_one_lens(from.view.camera(), to.view.camera())) return std::nullopt;
  const double stretch = to.object.largest_stretch();
  if (!is_uniform(glm::dmat3(to.object.object_to_eye()), stretch)) return std::nullopt;
  const glm::dmat3 axes_from = axes_of(from.view), axes_to = axes_of(to.view);
  glm::dmat3 change = axes_to - axes_from;
  if (is_turned) {  // the object itself is turned
    const glm::dmat3 linear_from(from.object.object_to_eye()), linear_to(to.object.object_to_eye());
    const double stretch_from = from.object.largest_stretch();
    if (!is_uniform(linear_from, stretch_from) || !(std::abs(stretch_from - stretch) <= 1e-12 * stretch))
      return std::nullopt;
    change = (axes_to * linear_to - axes_from * linear_from) / stretch;
  }
  // The Frobenius norm of a difference of two rotations is sqrt 2 times the largest change of a unit vector.
  const double frobenius =
      glm::dot(change[0], change[0]) + glm::dot(change[1], change[1]) + glm::dot(change[2], change[2]);
  const glm::dvec4 at_center(center, 1.0);
  const glm::dvec3 seen_from = axes_from * (from.object.object_to_eye() * at_center);
  const glm::dvec3 seen_to = axes_to * (to.object.object_to_eye() * at_center);
  const glm::dvec3 eye_from(from.object.eye()), eye_to(to.object.eye());
  const double rounding =
      2.0 * eye_slack *
      static_cast<double>(largest_coordinate(from.object.eye()) + largest_coordinate(to.object.eye()));
  constexpr double up = 1.0 + 1e-6;
  const Camera &lens_from = from.view.camera(), &lens_to = to.view.camera();
  const double range = (std::abs(lens_from.near - lens_to.near) + std::abs(lens_from.far - lens_to.far)) / stretch;
  ViewMotion motion;
  motion.eye_distance = up * glm::distance(eye_from, eye_to) + rounding + range;
  motion.center_distance = up * glm::distance(seen_from, seen_to) / stretch + 1e-14 * glm::length(seen_to) + range;
  motion.rotation_rad = up * std::sqrt(0.5 * frobenius) + (is_turned ? 1e-8 : 1e-12);
  if (!(std::isfinite(motion.eye_distance) && std::isfinite(motion.center_distance) && motion.rotation_rad < 0.5))
    return std::nullopt;
  return motion;
}

namespace {

// Returns a sphere around the corners of all faces.
Sphere sphere_around(const SplitStar& star, std::span<const glm::vec3> positions) {
  Box box{positions[star.vertex()], positions[star.vertex()]};
  const auto for_each_corner = [&](const auto& visit) {
    star.for_each_face([&](const Triangle& t) {
      for (int k = 0; k < 3; ++k) visit(positions[t[k]]);
    });
  };
  for_each_corner([&](const glm::vec3& p) { box = {glm::min(box.min, p), glm::max(box.max, p)}; });
  const float unit = inverse_power_of_two(box.max - box.min);
  const glm::vec3 center = 0.5F * box.min + 0.5F * box.max;
  float square = 0.0F;
  for_each_corner([&](const glm::vec3& p) {
    const glm::vec3 d = unit * (p - center);
    square = std::max(square, glm::dot(d, d));
  });
  return {center, std::sqrt(square) / unit};
}

FrontStar planes_of(const SplitStar& star, std::span<const glm::vec3> positions) {
  FrontStar planes;
  planes.has_too_many = star.inserted_count() + star.removed_count() > FrontStar::max_faces;
  if (planes.has_too_many) return planes;
  planes.sphere = sphere_around(star, positions);
  const float unit = inverse_power_of_two(planes.sphere.radius);
  star.for_each_face([&](const Triangle& t) {
    const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
    const glm::vec3 normal = glm::cross(unit * (b - a), unit * (c - a));
    const std::size_t i = planes.faces++;
    planes.normal_x[i] = normal.x;
    planes.normal_y[i] = normal.y;
    planes.normal_z[i] = normal.z;
    planes.offset[i] = glm::dot(normal, planes.sphere.center - a);
    planes.length[i] = glm::length(normal);
  });
  return planes;
}

}  // namespace

Front::Front(const Hierarchy& hierarchy, bool attributes)
    : hierarchy_(&hierarchy), attributes_(attributes), slots_(zeroed_array<std::uint32_t>(hierarchy.split_count())) {}

void Front::clear() {
  for (const FrontNode& node : nodes_) slots_[node.split] = 0;
  nodes_.clear();
  flags_.clear();
  errors_.clear();
  guaranteed_errors_.clear();
  visible_shares_.clear();
  forced_weights_.clear();
  scales_.clear();
  priorities_.clear();
  stars_.clear();
  free_stars_.clear();
}

Front::Index Front::obtain(SplitId s) {
  if (const Index there = find(s); there != none) return there;
  hierarchy_->require(s);
  const SplitNode& split = hierarchy_->node(s);
  nodes_.push_back({split.sphere, split.cone(), s});
  flags_.push_back(0);
  const SplitErrors errors = errors_of(*hierarchy_, s, attributes_);
  errors_.push_back(errors.mean);
  guaranteed_errors_.push_back(errors.guaranteed);
  visible_shares_.push_back(0.0F);
  forced_weights_.push_back(1.0F);
  scales_.add();
  priorities_.add();
  slots_[s] = static_cast<std::uint32_t>(nodes_.size());
  return slots_[s] - 1;
}

void Front::remove(Index k) {
  if (nodes_[k].star != FrontNode::no_star) free_stars_.push_back(nodes_[k].star);
  const SplitId gone = nodes_[k].split;
  slots_[nodes_.back().split] = slots_[gone];
  slots_[gone] = 0;
  const auto take_last = [&](auto& of) {
    of[k] = of.back();
    of.pop_back();
  };
  take_last(nodes_);
  take_last(flags_);
  take_last(errors_);
  take_last(guaranteed_errors_);
  take_last(visible_shares_);
  take_last(forced_weights_);
  scales_.remove(k);
  priorities_.remove(k);
}

void Front::set(Index k, Flag flag, bool on) noexcept {
  const unsigned one = flags_[k], changed = on ? one | flag : one & ~unsigned{flag};
  const bool any_hidden = (changed & (subtree_hidden | star_hidden)) != 0;
  flags_[k] = static_cast<std::uint16_t>(any_hidden ? changed | hidden : changed & ~unsigned{hidden});
}

void Front::read_star(Index k) {
  FrontNode& node = nodes_[k];
  if (node.star != FrontNode::no_star) return;
  const SplitStar star = star_of(*hierarchy_, node.split);
  star.for_each_face([&](const Triangle& t) {
    for (int corner = 0; corner < 3; ++corner) hierarchy_->require_vertex(t[corner]);
  });
  if (free_stars_.empty()) {
    free_stars_.push_back(static_cast<std::uint32_t>(stars_.size()));
    stars_.emplace_back();
  }
  node.star = free_stars_.back();
  free_stars_.pop_back();
  stars_[node.star] = planes_of(star, hierarchy_->positions());
}

}  // namespace occlod
