#include "refine/front_evaluation.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "base/arithmetic.h"
#include "base/threads.h"
#include "refine/tuning.h"
#include "refine/weigh.h"

namespace occlod {
namespace {

// Stars have about ten faces; the lanes behind them are left out, four at a time.
constexpr std::size_t lanes_at_once = 4;

// Calls visit(i) for the lanes of a star's faces, and perhaps a few more, which are zero.
template <typename Visit>
void for_each_lane(const FrontStar& star, const Visit& visit) {
  for (std::size_t first = 0; first < star.faces; first += lanes_at_once)
    for (std::size_t i = first; i < first + lanes_at_once; ++i) visit(i);
}

// Returns how far the eye may move while none of the faces turns its other side towards it, but for rounding.
float distance_from_planes(const FrontStar& star, const FrontStar::Lanes& facing) {
  std::array<float, lanes_at_once> least;
  least.fill(std::numeric_limits<float>::infinity());
  for_each_lane(star, [&](std::size_t i) {
    const float distance =
        star.length[i] > 0.0F ? std::abs(facing[i]) / star.length[i] : std::numeric_limits<float>::infinity();
    least[i % lanes_at_once] = std::min(least[i % lanes_at_once], distance);
  });
  return *std::min_element(least.begin(), least.end());
}

// Returns how the star is seen. The rays to all of its faces count as parallel.
StarView view_of(const FrontStar& star, FrontStar::Lanes& facing, const glm::vec3& eye, const FrontView& front_view) {
  const bool two_sided = front_view.two_sided;
  if (two_sided) for_each_lane(star, [&](std::size_t i) { facing[i] = std::abs(facing[i]); });
  std::uint32_t seen_faces = 0;
  float whole = 0.0F, seen = 0.0F;
  for_each_lane(star, [&](std::size_t i) {
    const bool is_seen = facing[i] > 0.0F;
    seen_faces += is_seen ? 1 : 0;
    whole += is_seen ? star.length[i] : 0.0F;
    seen += is_seen ? facing[i] : 0.0F;
  });
  StarView result;
  result.sphere = star.sphere;
  result.scale_px = front_view.view.largest_scale_px(star.sphere);
  if (two_sided) seen_faces = star.faces;
  if (star.faces > 0) result.visible_share = static_cast<float>(seen_faces) / static_cast<float>(star.faces);
  if (whole > 0.0F) result.cosine = std::min(seen / (whole * glm::length(eye)), 1.0F);
  return result;
}

// Returns the distance of the sphere from the nearest plane of the frustum, positive only when it is wholly inside.
float room_inside(const Sphere& sphere, const ObjectView& view) {
  float room = std::numeric_limits<float>::infinity();
  for (const glm::vec4& plane : view.planes()) {
    const float distance = glm::dot(glm::vec3(plane), sphere.center) + plane.w - sphere.radius;
    if (!(distance > 0.0F)) return 0.0F;
    room = std::min(room, distance);
  }
  return room;
}

// Returns the largest relative change of max(cosine, min_cosine)^exponent while the cosine loses or gains `change`.
float power_change(float cosine, float change, float exponent) {
  const float now = std::max(cosine, min_cosine);
  const float ratio = std::max(now / std::max(now - change, min_cosine), std::min(now + change, 1.0F) / now);
  return (exponent == 0.5F ? std::sqrt(ratio) : std::pow(ratio, exponent)) - 1.0F;
}

// Bounds the growth of errors as error_growth_of() in weigh_nodes.cpp does. While the eye moves by no more than a fifth
// of its distance, the cosine, the product of a direction and a mean of unit normals, changes by no more than 1.25
// times the way divided by the distance, but for the star's size; the change of the priority is steepest at the end.
ErrorGrowth error_growth_of(const StarView& seen, float from_eye, const FrontView& front_view) {
  if (front_view.view.is_orthographic()) return {};  // see motion_between()
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

std::optional<FrontPriority> front_priority(const FrontStar& star, const SplitErrors& errors,
                                            const FrontView& front_view) {
  const float room = room_inside(star.sphere, front_view.view);
  if (!(room > 0.0F)) return std::nullopt;
  const glm::vec3 from_center = front_view.view.eye() - star.sphere.center;
  const float unit = inverse_power_of_two(from_center);
  const glm::vec3 eye = unit * from_center;
  FrontStar::Lanes facing;
  for_each_lane(star, [&](std::size_t i) {
    facing[i] = star.normal_x[i] * eye.x + star.normal_y[i] * eye.y + star.normal_z[i] * eye.z + unit * star.offset[i];
  });
  const float from_planes =
      front_view.two_sided ? std::numeric_limits<float>::infinity() : distance_from_planes(star, facing) / unit;
  const StarView seen = view_of(star, facing, eye, front_view);
  FrontPriority result{front_view.importance.of(seen, errors),
                       error_growth_of(seen, glm::length(eye) / unit, front_view)};
  const float rounding =
      4e-6F * (star.sphere.radius + glm::length(star.sphere.center) + glm::length(front_view.view.eye()));
  ErrorGrowth& growth = result.growth;
  // A star that shows no face shows none outside the frustum either.
  if (seen.visible_share == 0.0F)
    growth = {0.0F, 0.0F, std::numeric_limits<float>::max(), 0.0F, std::numeric_limits<float>::max()};
  else
    growth.motion_limit = std::min(growth.motion_limit, 0.999F * room - rounding);
  growth.eye_distance_limit = std::min(growth.eye_distance_limit, 0.999F * from_planes - rounding);
  return result;
}

namespace {

// Fewer nodes, or stars, are not worth another thread.
constexpr std::size_t nodes_in_a_block = 1024, stars_in_a_block = 128;
constexpr std::size_t stars_ahead = 4;  // that are prefetched
constexpr SplitWorth not_found = {-1.0F, 0.0F, {}};
// Larger sums of motion count as rounded too much: in diagonals of the object, and in radians.
constexpr double max_motion = 64.0;
// Beyond these diagonals of objects, sums of squares near them might leave the range of floats.
constexpr double min_diagonal = 0x1p-40, max_diagonal = 0x1p40;
constexpr ErrorGrowth while_unseen = {0.0F, 0.0F, std::numeric_limits<float>::max(), 0.0F,
                                      std::numeric_limits<float>::max()};

glm::vec3 center_of(const Box& box) { return 0.5F * box.min + 0.5F * box.max; }

bool is_small_motion(const ViewMotion& motion, const Box& box) {
  const double diagonal = glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
  return diagonal >= min_diagonal && diagonal <= max_diagonal &&
         std::max(motion.eye_distance, motion.center_distance) <= max_motion * diagonal &&
         motion.rotation_rad <= max_motion;
}

}  // namespace

FrontEvaluation::FrontEvaluation(std::span<const RefineObject> objects) {
  for (const RefineObject& object : objects) objects_.emplace_back(object);
}

void FrontEvaluation::restart(const RefinedScene& scene) {
  scene_ = scene;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    objects_[i].front.clear();
    objects_[i].motion = {};
    see(i);
  }
  last_view_ = *scene_.view;
}

// Takes over this frame's view of an object.
void FrontEvaluation::see(std::uint32_t object) {
  const ObjectView& view = scene_.views[object];
  objects_[object].view = view;
  objects_[object].steepness = static_cast<float>(2.0 * tan_corner_angle(view));
}

void FrontEvaluation::move_to(const RefinedScene& scene) {
  scene_ = scene;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    move(i);
    evaluate_expired(i);
  }
  last_view_ = *scene_.view;
}

// Moves an object to the view of this frame. Everything expires when the motion is unknown or too large.
void FrontEvaluation::move(std::uint32_t object) {
  Object& of = objects_[object];
  const RefineOptions* const options = scene_.options;
  const ObjectView& view = scene_.views[object];
  const Box& box = scene_.hierarchy(object).box();
  const std::optional<ViewMotion> moved = motion_between({*last_view_, *of.view}, {*scene_.view, view}, center_of(box));
  see(object);
  if (moved) {
    of.motion.eye_distance += moved->eye_distance;
    of.motion.center_distance += moved->center_distance;
    of.motion.rotation_rad += moved->rotation_rad;
    if (is_small_motion(of.motion, box)) {
      of.front.scales().update(of.motion);
      if (tuning_of(*options).culling == Culling::star) of.front.priorities().update(of.motion);
      return;
    }
  }
  of.motion = {};
  of.front.scales().forget_all();
  of.front.priorities().forget_all();
}

std::size_t FrontEvaluation::node_count() const noexcept {
  std::size_t nodes = 0;
  for (const Object& object : objects_) nodes += object.front.size();
  return nodes;
}

BoundedProducts FrontEvaluation::errors(std::uint32_t object) const {
  const Front& front = objects_[object].front;
  return {front.scales(), front.errors(), front.flags()};
}

BoundedProducts FrontEvaluation::guaranteed_errors(std::uint32_t object) const {
  const Front& front = objects_[object].front;
  return {front.scales(), front.guaranteed_errors(), front.flags()};
}

BoundedProducts FrontEvaluation::priorities(std::uint32_t object) const {
  const RefineOptions* const options = scene_.options;
  if (tuning_of(*options).culling == Culling::subtree) return errors(object);
  const Front& front = objects_[object].front;
  return {front.priorities(), {}, front.flags()};
}

BoundedProducts FrontEvaluation::leaf_priorities(std::uint32_t object) const {
  const RefineOptions* const options = scene_.options;
  if (tuning_of(*options).culling == Culling::subtree) return errors(object);
  const Front& front = objects_[object].front;
  return {front.priorities(), front.forced_weights(), front.flags()};
}

float FrontEvaluation::most_grazing() const {
  constexpr float rounding = 1.001F;
  const RefineOptions* const options = scene_.options;
  return rounding * std::pow(min_cosine, -static_cast<float>(tuning_of(*options).grazing_exponent));
}

float FrontEvaluation::priority_at_most(std::uint32_t object, Front::Index k) const {
  const Front& front = objects_[object].front;
  const RefineOptions* const options = scene_.options;
  const float by_subtree = front.scales().error_factor[k] * front.error_at_most(k).quadric_px;
  if (tuning_of(*options).culling == Culling::subtree) return by_subtree;
  if (front.priorities().is_outdated(k)) return most_grazing() * by_subtree;
  return front.priorities().error_factor[k] * front.priorities().value[k];
}

void FrontEvaluation::evaluate(std::uint32_t object, std::span<const Front::Index> nodes) {
  Object& of = objects_[object];
  expired_.clear();
  for (const Front::Index k : nodes)
    if (!of.front.scales().is_exact(k)) expired_.push_back(k);
  const WeighingView now = {scene_.views[object], scene_.gate->tests_cone(object), of.motion,
                            center_of(scene_.hierarchy(object).box())};
  for_each_block(expired_.size(), nodes_in_a_block, scene_.threads, [&](std::size_t begin, std::size_t end, unsigned) {
    weigh_nodes(of.front, std::span(expired_).subspan(begin, end - begin), now);
  });
}

void FrontEvaluation::evaluate_expired(std::uint32_t object) {
  found_.clear();
  const Front& front = objects_[object].front;
  select({front.scales(), {}, front.flags()}, {.may_exceed = std::numeric_limits<float>::infinity()}, found_);
  evaluate(object, found_);
}

SplitWorth FrontEvaluation::worth(std::uint32_t object, Front::Index k) {
  const RefineOptions* const options = scene_.options;
  // A star has its own scale; whether the node is seen is known from earlier frames.
  const bool by_star = tuning_of(*options).culling == Culling::star;
  if (!by_star || objects_[object].front.scales().is_outdated(k)) evaluate(object, {&k, 1});
  if (const std::optional<SplitWorth> worth = find_worth(object, k)) return *worth;
  return worth_of_other(object, k);
}

void FrontEvaluation::find_worths(std::uint32_t object, std::span<const Front::Index> nodes,
                                  std::span<SplitWorth> worths) {
  const RefineOptions* const options = scene_.options;
  const bool by_star = tuning_of(*options).culling == Culling::star;
  const Front& front = objects_[object].front;
  outdated_.clear();
  outdated_.reserve(front.room());
  for (const Front::Index k : nodes)
    if (!by_star || front.scales().is_outdated(k)) outdated_.push_back(k);
  evaluate(object, outdated_);
  std::atomic<bool> any_other = false;
  for_each_block(nodes.size(), stars_in_a_block, scene_.threads, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < std::min(begin + stars_ahead, end); ++i) front.prefetch_star(nodes[i]);
    for (std::size_t i = begin; i < end; ++i) {
      if (i + 2 * stars_ahead < end) prefetch(&front.node(nodes[i + 2 * stars_ahead]));
      if (i + stars_ahead < end) front.prefetch_star(nodes[i + stars_ahead]);
      const std::optional<SplitWorth> worth = find_worth(object, nodes[i]);
      worths[i] = worth.value_or(not_found);
      if (!worth) any_other = true;
    }
  });
  if (!any_other) return;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (worths[i].priority == not_found.priority) worths[i] = worth_of_other(object, nodes[i]);
}

// Returns the worth of a node that has been evaluated, or nothing when that takes worth_of_other(). Several threads may
// call this for different nodes.
std::optional<SplitWorth> FrontEvaluation::find_worth(std::uint32_t object, Front::Index k) {
  Object& of = objects_[object];
  Front& front = of.front;
  if (front.is(k, Front::hidden)) return SplitWorth{};
  if (!(front.scales().value[k] > 0.0F)) {
    front.priorities().put(k, 0.0F, while_unseen, of.motion);
    front.visible_share(k) = 0.0F;
    return SplitWorth{};
  }
  const RefineOptions* const options = scene_.options;
  if (tuning_of(*options).culling == Culling::subtree) {
    const ScreenError error = front.error_at_most(k);
    return SplitWorth{error.quadric_px, error.quadric_px, error};
  }
  const FrontStar* const star = front.known_star(k);
  const ObjectView& view = scene_.views[object];
  if (star == nullptr || star->has_too_many) return std::nullopt;
  const std::optional<FrontPriority> found =
      front_priority(*star, {front.errors()[k], front.guaranteed_errors()[k]},
                     {view, scene_.importances[object], scene_.objects[object].two_sided,
                      static_cast<float>(tuning_of(*options).grazing_exponent), of.steepness,
                      center_of(scene_.hierarchy(object).box())});
  if (!found) return std::nullopt;
  return note(object, k, *found);
}

// Returns the worth of a split whose star has not been read yet, has many faces, or is not wholly inside the frustum.
SplitWorth FrontEvaluation::worth_of_other(std::uint32_t object, Front::Index k) {
  Front& front = objects_[object].front;
  if (front.known_star(k) == nullptr) {
    front.read_star(k);
    if (const std::optional<SplitWorth> worth = find_worth(object, k)) return *worth;
  }
  return note(object, k, {scene_.importances[object].of(front.node(k).split), {}});
}

// Keeps what the star of a node is worth.
SplitWorth FrontEvaluation::note(std::uint32_t object, Front::Index k, const FrontPriority& found) {
  Object& of = objects_[object];
  const bool is_seen = found.value.visible_share > 0.0F;
  const float priority = is_seen ? found.value.priority : 0.0F;
  of.front.priorities().put(k, priority, found.growth, of.motion);
  of.front.visible_share(k) = found.value.visible_share;
  if (!is_seen) return {};
  return {priority * of.front.forced_weight(k), priority, found.value.error};
}

AppliedCount FrontEvaluation::count_applied(float least) const {
  AppliedCount applied;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const BoundedProducts of = errors(i);
    const std::size_t all = count(of, {.all = Front::applied});
    applied.all += all;
    applied.worthless += all - count(of, {.all = Front::applied, .none = Front::subtree_hidden, .may_exceed = least});
  }
  return applied;
}

void FrontEvaluation::count_nodes(RefineStats& stats) const {
  constexpr std::uint16_t unseen = Front::outside | Front::facing_away;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const BoundedProducts of = errors(i);
    stats.nodes += count(of, {.all = Front::reached});
    stats.culled_frustum += count(of, {.all = Front::reached | Front::outside});
    stats.culled_backface += count(of, {.all = Front::reached | Front::facing_away});
    stats.culled_occlusion += count(of, {.all = Front::reached | Front::hidden, .none = unseen});
    if (tuning_of(*scene_.options).culling == Culling::subtree) continue;
    constexpr std::uint16_t all = Front::reached | Front::descended;
    constexpr std::uint16_t none = Front::applied | Front::hidden | unseen;
    const BoundedProducts own = priorities(i);  // expired priorities, which may be anything, cancel out
    stats.culled_backface +=
        count(own, {.all = all, .none = none}) - count(own, {.all = all, .none = none, .may_exceed = 0.0F});
  }
}

void FrontEvaluation::measure_errors(ScreenError& left) {
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    measure_unreached(i, errors(i), left.quadric_px, left);
    measure_unreached(i, guaranteed_errors(i), left.guaranteed_px, left);
  }
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    measure_unapplied(i, errors(i), left.quadric_px, left);
    measure_unapplied(i, guaranteed_errors(i), left.guaranteed_px, left);
  }
}

// Includes the bounds of subtrees that have not been descended.
void FrontEvaluation::measure_unreached(std::uint32_t object, const BoundedProducts& of, float so_far,
                                        ScreenError& left) {
  constexpr std::uint16_t all = Front::reached, none = Front::descended | Front::subtree_hidden;
  found_.clear();
  const float least = (1.0F - 1e-6F) * std::max(so_far, largest_at_least(of, all, none));
  select(of, {.all = all, .none = none, .may_exceed = least}, found_);
  evaluate(object, found_);
  for (const Front::Index k : found_) left.include(objects_[object].front.error_at_most(k));
}

namespace {

// Returns whether the error of a split may be larger than one of these.
bool may_exceed(const Front& front, Front::Index k, const ScreenError& error) {
  const ScreenError most = front.error_at_most(k);
  const float error_factor = front.scales().error_factor[k];
  return !(error_factor * most.quadric_px <= error.quadric_px &&
           error_factor * most.guaranteed_px <= error.guaranteed_px);
}

}  // namespace

// Includes the errors of stars of splits, where their subtree's bounds leave room for a larger one.
void FrontEvaluation::measure_unapplied(std::uint32_t object, const BoundedProducts& of, float so_far,
                                        ScreenError& left) {
  constexpr std::uint16_t all = Front::reached | Front::descended, none = Front::applied | Front::hidden;
  found_.clear();
  select(of, {.all = all, .none = none, .may_exceed = so_far}, found_);
  Front& front = objects_[object].front;
  const bool by_star = tuning_of(*scene_.options).culling == Culling::star;
  const auto known = std::partition(found_.begin(), found_.end(),
                                    [&](Front::Index k) { return by_star && !front.priorities().is_outdated(k); });
  const std::span unknown(known, found_.end());
  worths_.reserve(front.room());
  worths_.resize(unknown.size());
  find_worths(object, unknown, worths_);
  for (const SplitWorth& worth : worths_) left.include(worth.error);
  const std::span others(found_.begin(), known);
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (i + stars_ahead < others.size()) front.prefetch_star(others[i + stars_ahead]);
    const Front::Index k = others[i];
    const bool is_seen = front.priorities().value[k] > 0.0F;
    if (is_seen && may_exceed(front, k, left))
      left.include({front.errors()[k], front.guaranteed_errors()[k],
                    scene_.views[object].largest_scale_px(front.star(k).sphere)});
  }
}

}  // namespace occlod
