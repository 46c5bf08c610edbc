// How far the view of an object has moved: what bounds the change of everything that is seen in it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/memory.h"
#include "base/platform.h"
#include "occlod/hierarchy.h"
#include "occlod/view.h"
#include "refine/screen_error.h"

namespace occlod {

// Sums over frames: they only grow.
struct ViewMotion {
  double eye_distance = 0.0;     // that the eye has moved in object space
  double center_distance = 0.0;  // that the object's center has moved relative to the camera, object units
  double rotation_rad = 0.0;     // of the object's axes relative to the camera's

  // An upper bound of how far a point has moved relative to the camera; between two frames, their difference. `radius`
  // is the point's largest distance from the eye; or, where that is smaller, its distance from the object's center,
  // negated: for a camera that orbits the object, the center does not move. Rounded.
  [[nodiscard]] float displacement(float radius) const noexcept {
    return static_cast<float>(radius < 0.0F ? center_distance : eye_distance) +
           static_cast<float>(rotation_rad) * std::abs(radius);
  }
};

// Relative error of these sums by rounding, between two calls.
constexpr float motion_rounding = 4e-7F;

struct PlacedView {
  const View& view;
  const ObjectView& object;
};

// Between two views of one object with this center, in object space; it may have been moved and turned in between.
// Nothing when they differ in more than where the eye is, where it looks and where the object is, when they are
// orthographic and differ at all, or when the object is stretched more in one direction than in another.
[[nodiscard]] std::optional<ViewMotion> motion_between(const PlacedView& from, const PlacedView& to,
                                                       const glm::vec3& center);

// Numbers that change at bounded rates while the view moves, one for each node of a front.

// By how much a value may be off after the view has moved, and how far it may move before the value expires.
struct ErrorGrowth {
  float radius = 0.0F;  // of what the value depends on: see ViewMotion::displacement
  // After a displacement of d <= motion_limit the value is right to within a factor of 1 + per_motion * d, and a zero
  // is still zero.
  float per_motion = 0.0F;
  float motion_limit = -1.0F;  // < 0: it expires at once
  // The same for the distance that the eye has moved; both factors apply.
  float per_eye_distance = 0.0F;
  float eye_distance_limit = -1.0F;
};

// Values with the growth of their errors, and the sums of motion when they were computed.
struct BoundedValues {
  std::vector<float> value;  // >= 0, perhaps infinite
  // The factor to within which the value is right in this frame: 1 when it was computed in this frame, NaN when it has
  // expired.
  std::vector<float> error_factor;
  std::vector<float> radius, motion_then, per_motion, motion_limit;
  std::vector<float> eye_distance_then, per_eye_distance, eye_distance_limit;

  void add();
  // Moves the last one into its place.
  void remove(std::size_t k);
  void clear();
  void put(std::size_t k, float computed, const ErrorGrowth& growth, const ViewMotion& now);
  // It expires.
  void forget(std::size_t k);
  void forget_all();
  // Sets error_factor for the view that has moved so far. O(values), in vectors.
  void update(const ViewMotion& now);

  [[nodiscard]] bool is_exact(std::size_t k) const noexcept { return error_factor[k] == 1.0F; }
  [[nodiscard]] bool is_outdated(std::size_t k) const noexcept { return error_factor[k] != error_factor[k]; }
};

// Which nodes: by their flags, and by value * weight as far as it is known. An expired value may be anything.
struct Selection {
  std::uint16_t all = 0;  // of these flags
  std::uint16_t none = 0;
  float may_exceed = -1.0F;
  float may_be_below = std::numeric_limits<float>::infinity();  // infinity: any
};

// All that selecting reads. `weights`: empty = 1 each; where a weight is 0 so is the product.
struct BoundedProducts {
  const BoundedValues& values;
  std::span<const float> weights;
  std::span<const std::uint16_t> flags;
};

// Appends the indices of selected nodes, ascending. O(nodes), in vectors.
void select(const BoundedProducts& products, const Selection& selection, std::vector<std::uint32_t>& out);
[[nodiscard]] std::size_t count(const BoundedProducts& products, const Selection& selection);
// Of the nodes with these flags: the largest product is no smaller.
[[nodiscard]] float largest_at_least(const BoundedProducts& products, std::uint16_t all, std::uint16_t none);

// The part of one object's forest that refinement has reached, kept from frame to frame.

// A split that is applied, or may be looked at or applied next: what is read where something changes.
struct alignas(64) FrontNode {
  static constexpr std::uint32_t no_star = no_id;

  Sphere sphere;
  NormalCone cone;
  SplitId split = no_id;
  std::uint32_t star = no_star;     // see Front::star
  std::uint16_t level = 0;          // in the forest, 0 at roots; stays at the largest number
  std::uint16_t subtree_shown = 0;  // low bits of the number of the occluder before which its subtree was last visible
  std::uint16_t star_shown = 0;     // and its star
  std::uint16_t weighed_frame = 0;  // low bits of the number of the frame in which unseen_needs was found
  float unseen_needs = 0.0F;        // see UnseenNeeds

  static std::uint16_t below(std::uint16_t level) noexcept {
    return level == std::numeric_limits<std::uint16_t>::max() ? level : static_cast<std::uint16_t>(level + 1);
  }
};
static_assert(sizeof(FrontNode) == 64, "one cache line");

// The planes of a split's faces, for many looks from many eyes.
struct FrontStar {
  static constexpr std::size_t max_faces = 16;
  using Lanes = std::array<float, max_faces>;

  // Of face i: its normal, twice its area long in a unit near the star's size, and dot(normal, sphere.center - corner).
  alignas(64) Lanes normal_x{}, normal_y{}, normal_z{}, offset{}, length{};
  Sphere sphere;              // around all corners
  std::uint32_t faces = 0;    // in the first lanes; all other lanes are zero
  bool has_too_many = false;  // more than max_faces: nothing else is known
};

// Nodes by index. What every frame looks through lies in arrays of its own, in the order of nodes.
class Front {
 public:
  using Index = std::uint32_t;
  static constexpr Index none = no_id;

  enum Flag : std::uint16_t {
    reached = 1,          // a root, or its forest parent has been descended
    descended = 2,        // its children are reached
    applied = 4,          // by the cut
    leaf = 8,             // applied, and no applied split needs it
    subtree_hidden = 16,  // by the occluder that it was last asked about against
    star_hidden = 32,
    hidden = 64,           // either
    is_new = 128,          // applied in this frame
    outside = 256,         // the frustum
    facing_away = 512,     // inside it
    weighed = 1024,        // its forced_weight() is known
    forced = 2048,         // applied only because another split depends on it
    forced_unseen = 4096,  // and changed nothing that was seen then
    needs_known = 8192,    // its unseen_needs have been found
  };

  // `attributes`: their errors count too.
  Front(const Hierarchy& hierarchy, bool attributes);

  // Back to nothing. O(nodes).
  void clear();

  [[nodiscard]] std::size_t size() const noexcept { return nodes_.size(); }
  // Of s, or none.
  [[nodiscard]] Index find(SplitId s) const noexcept { return slots_[s] == 0 ? none : slots_[s] - 1; }
  // Of s, made if there is none. Throws Error when s is damaged.
  Index obtain(SplitId s);
  // Moves the last node into its place.
  void remove(Index k);

  [[nodiscard]] FrontNode& node(Index k) noexcept { return nodes_[k]; }
  [[nodiscard]] const FrontNode& node(Index k) const noexcept { return nodes_[k]; }
  [[nodiscard]] bool is(Index k, std::uint32_t all) const noexcept { return (flags_[k] & all) == all; }
  void set(Index k, Flag flag, bool on) noexcept;
  [[nodiscard]] std::span<const std::uint16_t> flags() const noexcept { return flags_; }

  // What it leaves on the screen at most while it is not applied, by its scale as it was found last.
  [[nodiscard]] ScreenError error_at_most(Index k) const noexcept {
    return {errors_[k], guaranteed_errors_[k], scales_.value[k]};
  }
  [[nodiscard]] std::span<const float> errors() const noexcept { return errors_; }
  [[nodiscard]] std::span<const float> guaranteed_errors() const noexcept { return guaranteed_errors_; }

  // Pixels per object unit at the sphere; 0 when the subtree is outside or faces away.
  [[nodiscard]] BoundedValues& scales() noexcept { return scales_; }
  [[nodiscard]] const BoundedValues& scales() const noexcept { return scales_; }
  // Priorities by the split's own star, without what it forces and without what is hidden.
  [[nodiscard]] BoundedValues& priorities() noexcept { return priorities_; }
  [[nodiscard]] const BoundedValues& priorities() const noexcept { return priorities_; }
  // The share of its star that was seen when its priority was found; it holds as long as that does.
  [[nodiscard]] float& visible_share(Index k) noexcept { return visible_shares_[k]; }
  // See Importance, when its closure was last looked at; 1 before that.
  [[nodiscard]] float& forced_weight(Index k) noexcept { return forced_weights_[k]; }
  [[nodiscard]] std::span<const float> forced_weights() const noexcept { return forced_weights_; }

  // The faces of a node's split, read when they are asked for first.
  const FrontStar& star(Index k);
  // They will be asked for soon.
  void prefetch_star(Index k) const noexcept {
    if (nodes_[k].star == FrontNode::no_star) return;
    const auto* const lines = reinterpret_cast<const char*>(&stars_[nodes_[k].star]);
    for (std::size_t at = 0; at < sizeof(FrontStar); at += 64) prefetch(lines + at);
  }

 private:
  const Hierarchy* hierarchy_;
  bool attributes_;
  ZeroedArray<std::uint32_t> slots_;  // of each split: 1 + its index
  std::vector<FrontNode> nodes_;
  std::vector<std::uint16_t> flags_;
  std::vector<float> errors_, guaranteed_errors_, visible_shares_, forced_weights_;
  BoundedValues scales_, priorities_;
  std::vector<FrontStar> stars_;
  std::vector<std::uint32_t> free_stars_;
};

}  // namespace occlod
