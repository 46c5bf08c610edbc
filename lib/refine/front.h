// The part of one object's forest that refinement has reached, kept from frame to frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/platform.h"
#include "base/zeroed_array.h"
#include "occlod/hierarchy/hierarchy.h"
#include "refine/bounded_values.h"
#include "refine/screen_error.h"
#include "refine/view_motion.h"

namespace occlod {

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
  static constexpr std::size_t most_faces = 16;
  using Lanes = std::array<float, most_faces>;

  // Of face i: its normal, twice its area long in a unit near the star's size, and dot(normal, sphere.center - corner).
  alignas(64) Lanes normal_x{}, normal_y{}, normal_z{}, offset{}, length{};
  Sphere sphere;              // around all corners
  std::uint32_t faces = 0;    // in the first lanes; all other lanes are zero
  bool has_too_many = false;  // more than most_faces: nothing else is known
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
