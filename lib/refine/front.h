// Keeps what refinement has reached of the split forest, and how far the view may move before that must be evaluated
// anew.
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

// Bounds how far the view of an object has moved. The sums over frames only grow.
struct ViewMotion {
  double eye_distance = 0.0;     // distance that the eye has moved, object units
  double center_distance = 0.0;  // distance that the object's center has moved relative to the camera, object units
  double rotation_rad = 0.0;     // rotation of the object's axes relative to the camera's

  // Returns an upper bound on how far a point has moved relative to the camera; between two frames, it is the
  // difference. `radius` is the point's largest distance from the eye or, where that is smaller, minus its distance
  // from the object's center, which does not move for a camera that orbits the object. The result is rounded.
  [[nodiscard]] float displacement(float radius) const noexcept {
    return static_cast<float>(radius < 0.0F ? center_distance : eye_distance) +
           static_cast<float>(rotation_rad) * std::abs(radius);
  }
};

// Relative rounding error of these sums between two calls.
constexpr float motion_rounding = 4e-7F;

struct PlacedView {
  const View& view;
  const ObjectView& object;
};

// Returns the motion between two views of one object with this center, in object space; the object may have been moved
// and turned in between. Returns nothing when the views differ in more than where the eye is, where it looks and where
// the object is, when they are orthographic and differ at all, or when the object is stretched more in one direction
// than in another.
[[nodiscard]] std::optional<ViewMotion> motion_between(const PlacedView& from, const PlacedView& to,
                                                       const glm::vec3& center);

// Bounds how wrong a value may be after the view has moved, and how far the view may move before the value expires.
struct ErrorGrowth {
  float radius = 0.0F;  // for ViewMotion::displacement() of what the value depends on
  // After a displacement d <= motion_limit the value is right to within a factor of 1 + per_motion * d, and a zero is
  // still zero.
  float per_motion = 0.0F;
  float motion_limit = -1.0F;  // < 0: the value expires at once
  // These do the same for the distance that the eye has moved; both factors apply.
  float per_eye_distance = 0.0F;
  float eye_distance_limit = -1.0F;
};

// Holds a value per node that changes at a bounded rate while the view moves, the growth of its error, and the sums of
// motion when it was computed.
struct BoundedValues {
  std::vector<float> value;  // >= 0, perhaps infinite
  // Factor to within which the value is right in this frame: 1 when it was computed in this frame, NaN when it has
  // expired.
  std::vector<float> error_factor;
  std::vector<float> radius, motion_then, per_motion, motion_limit;
  std::vector<float> eye_distance_then, per_eye_distance, eye_distance_limit;

  void add();
  // Removes a value and moves the last one into its place.
  void remove(std::size_t k);
  void clear();
  void put(std::size_t k, float computed, const ErrorGrowth& growth, const ViewMotion& now);
  // Lets a value expire.
  void forget(std::size_t k);
  void forget_all();
  // Sets error_factor for the motion so far. O(values), in vectors.
  void update(const ViewMotion& now);

  [[nodiscard]] bool is_exact(std::size_t k) const noexcept { return error_factor[k] == 1.0F; }
  [[nodiscard]] bool is_outdated(std::size_t k) const noexcept { return error_factor[k] != error_factor[k]; }
};

// Selects nodes by their flags and by value * weight, as far as it is known. An expired value may be anything.
struct Selection {
  std::uint16_t all = 0;  // flags that must be set
  std::uint16_t none = 0;
  float may_exceed = -1.0F;
  float may_be_below = std::numeric_limits<float>::infinity();  // infinity: any value
};

// Refers to all data that selecting reads. Empty `weights` mean 1 each; where a weight is 0, so is the product.
struct BoundedProducts {
  const BoundedValues& values;
  std::span<const float> weights;
  std::span<const std::uint16_t> flags;
};

// Appends the indices of selected nodes, ascending. O(nodes), in vectors.
void select(const BoundedProducts& products, const Selection& selection, std::vector<std::uint32_t>& out);
[[nodiscard]] std::size_t count(const BoundedProducts& products, const Selection& selection);
// Returns a lower bound on the largest product of the nodes with these flags.
[[nodiscard]] float largest_at_least(const BoundedProducts& products, std::uint16_t all, std::uint16_t none);

// Holds a split that is applied, or may be visited or applied next, with the data that is read where something changes.
struct alignas(64) FrontNode {
  static constexpr std::uint32_t no_star = no_id;

  Sphere sphere;
  NormalCone cone;
  SplitId split = no_id;
  std::uint32_t star = no_star;     // index in Front::stars_
  std::uint16_t level = 0;          // level in the forest, 0 at roots; stays at the largest number
  std::uint16_t subtree_shown = 0;  // low bits of the number of the last occluder that showed its subtree
  std::uint16_t star_shown = 0;     // low bits of the number of the last occluder that showed its star
  std::uint16_t weighed_frame = 0;  // low bits of the number of the frame in which unseen_needs was found
  float unseen_needs = 0.0F;        // see UnseenNeeds

  static std::uint16_t below(std::uint16_t level) noexcept {
    return level == std::numeric_limits<std::uint16_t>::max() ? level : static_cast<std::uint16_t>(level + 1);
  }
};
static_assert(sizeof(FrontNode) == 64, "one cache line");

// Holds the planes of a split's faces, for looking at them from many eyes.
struct FrontStar {
  static constexpr std::size_t max_faces = 16;
  using Lanes = std::array<float, max_faces>;

  // For face i: its normal, twice its area long in a unit near the star's size, and dot(normal, sphere.center -
  // corner).
  alignas(64) Lanes normal_x{}, normal_y{}, normal_z{}, offset{}, length{};
  Sphere sphere;              // sphere around all corners
  std::uint32_t faces = 0;    // number of faces, in the first lanes; all other lanes are zero
  bool has_too_many = false;  // whether there are more than max_faces; then nothing else is known
};

// Holds nodes by index. What every frame scans lies in separate arrays, in the order of nodes.
class Front {
 public:
  using Index = std::uint32_t;
  static constexpr Index none = no_id;

  enum Flag : std::uint16_t {
    reached = 1,          // a root, or its forest parent has been descended
    descended = 2,        // its children are reached
    applied = 4,          // in the cut
    leaf = 8,             // applied, and no applied split needs it
    subtree_hidden = 16,  // hidden by the occluder that it was last tested against
    star_hidden = 32,
    hidden = 64,           // subtree_hidden or star_hidden
    is_new = 128,          // applied in this frame
    outside = 256,         // outside the frustum
    facing_away = 512,     // faces away, inside the frustum
    weighed = 1024,        // its forced_weight() is known
    forced = 2048,         // applied only because another split depends on it
    forced_unseen = 4096,  // forced, and changed nothing that was seen then
    needs_known = 8192,    // its unseen_needs have been found
    covered = 16384,       // its vertex is covered, but not its star: see OcclusionQueries::Verdict
  };

  // `attributes`: whether their errors count too.
  Front(const Hierarchy& hierarchy, bool attributes);

  // Removes all nodes. O(nodes).
  void clear();

  [[nodiscard]] std::size_t size() const noexcept { return nodes_.size(); }
  // Returns for how many nodes there is room: scratch that has as much allocates when the front does, and not else.
  [[nodiscard]] std::size_t room() const noexcept { return nodes_.capacity(); }
  // Returns the index of s, or none.
  [[nodiscard]] Index find(SplitId s) const noexcept { return slots_[s] == 0 ? none : slots_[s] - 1; }
  // Returns the index of s, and adds its node if there is none. Throws Error when s is damaged.
  Index obtain(SplitId s);
  // Removes a node and moves the last one into its place.
  void remove(Index k);

  [[nodiscard]] FrontNode& node(Index k) noexcept { return nodes_[k]; }
  [[nodiscard]] const FrontNode& node(Index k) const noexcept { return nodes_[k]; }
  [[nodiscard]] bool is(Index k, std::uint32_t all) const noexcept { return (flags_[k] & all) == all; }
  void set(Index k, Flag flag, bool on) noexcept;
  [[nodiscard]] std::span<const std::uint16_t> flags() const noexcept { return flags_; }

  // Returns the largest error that the node leaves on the screen while it is not applied, by the scale found last.
  [[nodiscard]] ScreenError error_at_most(Index k) const noexcept {
    return {errors_[k], guaranteed_errors_[k], scales_.value[k]};
  }
  [[nodiscard]] std::span<const float> errors() const noexcept { return errors_; }
  [[nodiscard]] std::span<const float> guaranteed_errors() const noexcept { return guaranteed_errors_; }

  // Return scales in pixels per object unit at the sphere; 0 when the subtree is outside or faces away.
  [[nodiscard]] BoundedValues& scales() noexcept { return scales_; }
  [[nodiscard]] const BoundedValues& scales() const noexcept { return scales_; }
  // Return priorities by the split's own star, without what it forces and without what is hidden.
  [[nodiscard]] BoundedValues& priorities() noexcept { return priorities_; }
  [[nodiscard]] const BoundedValues& priorities() const noexcept { return priorities_; }
  // Returns the share of the star that was seen when the priority was found; valid as long as the priority.
  [[nodiscard]] float& visible_share(Index k) noexcept { return visible_shares_[k]; }
  // Returns the factor for what the split forces or keeps, as weighed last, and for a covered vertex; 1 before that.
  [[nodiscard]] float& forced_weight(Index k) noexcept { return forced_weights_[k]; }
  [[nodiscard]] std::span<const float> forced_weights() const noexcept { return forced_weights_; }

  // Reads the faces of a node's split, unless that has been done. Throws Error when they are damaged.
  void read_star(Index k);
  // Returns the faces of a node's split; null before read_star().
  [[nodiscard]] const FrontStar* known_star(Index k) const noexcept {
    return nodes_[k].star == FrontNode::no_star ? nullptr : &stars_[nodes_[k].star];
  }
  const FrontStar& star(Index k) {
    read_star(k);
    return *known_star(k);
  }
  // Prefetches the faces of a node's split.
  void prefetch_star(Index k) const noexcept {
    if (nodes_[k].star == FrontNode::no_star) return;
    const auto* const lines = reinterpret_cast<const char*>(&stars_[nodes_[k].star]);
    for (std::size_t at = 0; at < sizeof(FrontStar); at += 64) prefetch(lines + at);
  }

 private:
  const Hierarchy* hierarchy_;
  bool attributes_;
  ZeroedArray<std::uint32_t> slots_;  // per split: 1 + index of its node, or 0
  std::vector<FrontNode> nodes_;
  std::vector<std::uint16_t> flags_;
  std::vector<float> errors_, guaranteed_errors_, visible_shares_, forced_weights_;
  BoundedValues scales_, priorities_;
  std::vector<FrontStar> stars_;
  std::vector<std::uint32_t> free_stars_;
};

}  // namespace occlod
