// The part of one object's forest that refinement has reached, kept from frame to frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/view/view.h"
#include "zeroed_array.h"

namespace occlod {

// A split that is applied, or may be looked at or applied next. A copy of what every frame needs, so that a frame reads
// memory in order.
struct FrontNode {
  enum Flag : std::uint8_t {
    reached = 1,         // a root, or its forest parent has been descended
    descended = 2,       // its children are reached
    applied = 4,         // by the cut
    subtree_hidden = 8,  // by the occluder that it was last asked about against
    star_hidden = 16,
    is_new = 32,  // applied in this frame
  };
  static constexpr std::uint32_t no_star = no_id;

  Sphere sphere;
  NormalCone cone;
  float error = 0.0F;
  float guaranteed_error = 0.0F;
  SplitId split = no_id;
  float scale_px = 0.0F;            // at the sphere; 0 when the subtree is outside or faces away
  float forced_weight = 1.0F;       // see Importance, when its closure was last looked at
  std::uint32_t star = no_star;     // see Front::star
  std::uint16_t level = 0;          // in the forest, 0 at roots; stays at the largest number
  std::uint16_t subtree_shown = 0;  // low bits of the number of the occluder before which its subtree was last visible
  std::uint16_t star_shown = 0;     // and its star
  std::uint8_t flags = 0;

  static std::uint16_t below(std::uint16_t level) noexcept {
    return level == std::numeric_limits<std::uint16_t>::max() ? level : static_cast<std::uint16_t>(level + 1);
  }
  [[nodiscard]] bool is(std::uint32_t all) const noexcept { return (flags & all) == all; }
  void set(Flag flag, bool on) noexcept { flags = static_cast<std::uint8_t>(on ? flags | flag : flags & ~flag); }
  [[nodiscard]] float quadric_px() const noexcept { return scale_px > 0.0F && error > 0.0F ? error * scale_px : 0.0F; }
  [[nodiscard]] float guaranteed_px() const noexcept {
    return scale_px > 0.0F && guaranteed_error > 0.0F ? guaranteed_error * scale_px : 0.0F;
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

class Front {
 public:
  explicit Front(const Hierarchy& hierarchy);

  // Back to nothing. O(nodes).
  void clear();

  [[nodiscard]] std::span<FrontNode> nodes() noexcept { return nodes_; }
  [[nodiscard]] std::span<const FrontNode> nodes() const noexcept { return nodes_; }
  // Of s, or null.
  [[nodiscard]] FrontNode* find(SplitId s) noexcept { return slots_[s] == 0 ? nullptr : &nodes_[slots_[s] - 1]; }
  [[nodiscard]] const FrontNode* find(SplitId s) const noexcept {
    return slots_[s] == 0 ? nullptr : &nodes_[slots_[s] - 1];
  }
  // Of s, made if there is none. Moves nodes. Throws Error when s is damaged.
  FrontNode& obtain(SplitId s);
  // Moves the last node into its place.
  void remove(FrontNode& node);

  // The faces of a node's split, read when they are asked for first.
  const FrontStar& star(FrontNode& node);

 private:
  const Hierarchy* hierarchy_;
  ZeroedArray<std::uint32_t> slots_;  // of each split: 1 + its index in nodes_
  std::vector<FrontNode> nodes_;
  std::vector<FrontStar> stars_;
  std::vector<std::uint32_t> free_stars_;
  std::vector<VertexId> corners_;  // scratch
};

}  // namespace occlod
