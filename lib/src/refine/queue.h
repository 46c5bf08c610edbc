// What refinement may do next, worst first.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

// What a split that is not applied leaves on the screen, at most.
struct ScreenError {
  float quadric_px = 0.0F;
  float guaranteed_px = 0.0F;

  ScreenError() = default;
  ScreenError(float error, float guaranteed_error, float scale_px)
      : quadric_px(in_pixels(error, scale_px)), guaranteed_px(in_pixels(guaranteed_error, scale_px)) {}
  ScreenError(const SplitNode& node, float scale_px) : ScreenError(node.error, node.guaranteed_error, scale_px) {}
  // Where an unlimited scale leaves no error at 0.
  static float in_pixels(float error, float scale_px) { return error > 0.0F ? error * scale_px : 0.0F; }
  void include(const ScreenError& o) {
    quadric_px = std::max(quadric_px, o.quadric_px);
    guaranteed_px = std::max(guaranteed_px, o.guaranteed_px);
  }
};

// Something that refinement may do next.
struct Entry {
  enum class Kind : std::uint8_t {
    visit,  // look at a node: descend below it
    apply,  // apply the split itself
  };
  float priority = 0.0F;  // quadric screen error in pixels, weighted
  ScreenError error;      // unweighted
  SplitId split = no_id;
  std::uint32_t object = 0;
  std::uint32_t level = 0;           // of the split in the forest, 0 at roots
  std::uint32_t asked_occluder = 0;  // number of the occluder that it was last found visible against; 0 = never asked
  Kind kind = Kind::visit;
  bool weighed = false;  // priority includes what the split forces
};

// Worst first, to within a sixty-fourth of a factor of two; of entries that are as bad, the last one in comes out
// first, which has just been looked at. Pushing and popping take constant time where a heap's would miss the caches all
// along its height. Keeps its memory.
class Queue {
 public:
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] const Entry& top() const noexcept { return nodes_[first_[top_]].entry; }
  // Whether it would come out before all others.
  [[nodiscard]] bool would_be_next(const Entry& entry) const noexcept { return empty() || bucket_of(entry) >= top_; }

  void clear() noexcept;
  void push(const Entry& entry);
  Entry pop();

  // Calls visit(const Entry&) for each.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (const std::uint32_t first : first_)
      for (std::uint32_t at = first; at != none; at = nodes_[at].next) visit(nodes_[at].entry);
  }

 private:
  struct Node {
    Entry entry;
    std::uint32_t next = none;  // in its bucket, or in the list of free nodes
  };
  static constexpr std::uint32_t none = no_id;
  static constexpr int dropped_bits = 17;  // of a float: its exponent and six bits of its mantissa are left
  static constexpr std::size_t bucket_count = std::size_t{1} << (31 - dropped_bits);
  static constexpr std::size_t word_bits = 64;

  static std::size_t bucket_of(const Entry& entry) noexcept {
    return entry.priority > 0.0F ? std::bit_cast<std::uint32_t>(entry.priority) >> dropped_bits : 0;
  }
  void find_top() noexcept;

  std::vector<Node> nodes_;
  std::uint32_t free_ = none;
  std::size_t size_ = 0;
  std::size_t top_ = 0;  // the highest bucket that is not empty, if any is
  std::vector<std::uint32_t> first_ = std::vector<std::uint32_t>(bucket_count, none);
  std::array<std::uint64_t, bucket_count / word_bits> occupied_{};  // a bit for each bucket
};

}  // namespace occlod
