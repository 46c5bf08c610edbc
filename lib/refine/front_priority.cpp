#include "refine/front_priority.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "base/inverse_power_of_two.h"
#include "refine/weighed_lanes.h"

namespace occlod {
namespace {

// How far the eye may move while none of the faces turns its other side towards it, but for rounding.
float distance_from_planes(const FrontStar::Lanes& facing, const FrontStar::Lanes& length) {
  FrontStar::Lanes distance;
  for (std::size_t i = 0; i < FrontStar::most_faces; ++i)
    distance[i] = length[i] > 0.0F ? std::abs(facing[i]) / length[i] : std::numeric_limits<float>::infinity();
  for (std::size_t half = FrontStar::most_faces / 2; half > 0; half /= 2)
    for (std::size_t i = 0; i < half; ++i) distance[i] = std::min(distance[i], distance[i + half]);
  return distance[0];
}

// The rays to all of its faces count as parallel.
StarView view_of(const FrontStar& star, FrontStar::Lanes& facing, const glm::vec3& eye, const FrontView& front_view) {
  const bool two_sided = front_view.two_sided;
  if (two_sided)
    for (float& f : facing) f = std::abs(f);
  std::uint32_t seen_faces = 0;
  float whole = 0.0F, seen = 0.0F;
  for (std::size_t i = 0; i < FrontStar::most_faces; ++i) {
    const bool is_seen = facing[i] > 0.0F;
    seen_faces += is_seen ? 1 : 0;
    whole += is_seen ? star.length[i] : 0.0F;
    seen += is_seen ? facing[i] : 0.0F;
  }
  StarView result;
  result.sphere = star.sphere;
  result.scale_px = front_view.view.largest_scale_px(star.sphere);
  if (two_sided) seen_faces = star.faces;
  if (star.faces > 0) result.visible_share = static_cast<float>(seen_faces) / static_cast<float>(star.faces);
  if (whole > 0.0F) result.cosine = std::min(seen / (whole * glm::length(eye)), 1.0F);
  return result;
}

// How far the sphere is from the nearest plane of the frustum, inside.
float room_inside(const Sphere& sphere, const ObjectView& view) {
  float room = std::numeric_limits<float>::infinity();
  for (const glm::vec4& plane : view.planes())
    room = std::min(room, glm::dot(glm::vec3(plane), sphere.center) + plane.w - sphere.radius);
  return room;
}

// By how much of itself a cosine to a power between `cosine` and the least that counts changes at most while it loses
// or gains `change`.
float power_change(float cosine, float change, float exponent) {
  const float now = std::max(cosine, least_cosine);
  const float ratio = std::max(now / std::max(now - change, least_cosine), std::min(now + change, 1.0F) / now);
  return (exponent == 0.5F ? std::sqrt(ratio) : std::pow(ratio, exponent)) - 1.0F;
}

// See the lanes of weigh_nodes.cpp. While the eye moves by no more than a fifth of its distance, the cosine, that of
// the mean of unit normals at most, changes by no more than 1.25 times the way in distances, but for the star's size;
// what it does to the priority is steepest where it ends.
ErrorGrowth error_growth_of(const StarView& seen, float from_eye, const FrontView& front_view) {
  if (front_view.view.is_orthographic()) return {};  // see motion_between
  const Sphere& sphere = seen.sphere;
  const auto stretch = static_cast<float>(front_view.view.largest_stretch());
  const float radius = sphere.radius * stretch;
  const auto distance_now =
      static_cast<float>(glm::length(front_view.view.object_to_eye() * glm::dvec4(sphere.center, 1.0)));
  if (!(distance_now > 1.001F * radius)) return {};
  const float nearest = 0.75F * (distance_now - radius), distance = nearest + radius;
  const float widening = radius / std::sqrt(nearest * (distance + radius));
  const float rate = stretch * (1.0F / nearest + front_view.steepness * (1.0F + widening) / distance);
  const float motion_limit = std::min(std::numbers::ln2_v<float> / rate, nearest / (3.0F * stretch));
  const float eye_distance_limit = 0.2F * from_eye;
  const float cosine_change = 0.26F * (1.0F + sphere.radius / from_eye);
  const float per_eye_distance =
      power_change(seen.cosine, cosine_change, front_view.grazing_exponent) / eye_distance_limit;
  const float from_object_center = glm::distance(front_view.center, sphere.center);
  const float reach = 2.0F * from_object_center < from_eye ? -from_object_center : 1.25F * from_eye + sphere.radius;
  return {(1.0F + 1e-5F) * reach, 1.001F / motion_limit, 0.999F * motion_limit, 1.001F * per_eye_distance,
          0.999F * eye_distance_limit};
}

}  // namespace

FrontPriority front_priority(const FrontStar& star, const SplitErrors& errors, const FrontView& front_view) {
  const glm::vec3 from_center = front_view.view.eye() - star.sphere.center;
  const float unit = inverse_power_of_two(from_center);
  const glm::vec3 eye = unit * from_center;
  FrontStar::Lanes facing;
  for (std::size_t i = 0; i < FrontStar::most_faces; ++i)
    facing[i] = star.normal_x[i] * eye.x + star.normal_y[i] * eye.y + star.normal_z[i] * eye.z + unit * star.offset[i];
  const float from_planes =
      front_view.two_sided ? std::numeric_limits<float>::infinity() : distance_from_planes(facing, star.length) / unit;
  const StarView seen = view_of(star, facing, eye, front_view);
  FrontPriority result{front_view.importance.of(seen, errors),
                       error_growth_of(seen, glm::length(eye) / unit, front_view)};
  const float rounding =
      4e-6F * (star.sphere.radius + glm::length(star.sphere.center) + glm::length(front_view.view.eye()));
  ErrorGrowth& growth = result.growth;
  // What shows no face shows none outside either.
  if (seen.visible_share == 0.0F)
    growth = {0.0F, 0.0F, std::numeric_limits<float>::max(), 0.0F, std::numeric_limits<float>::max()};
  else
    growth.motion_limit = std::min(growth.motion_limit, 0.999F * room_inside(star.sphere, front_view.view) - rounding);
  growth.eye_distance_limit = std::min(growth.eye_distance_limit, 0.999F * from_planes - rounding);
  return result;
}

}  // namespace occlod
