// What refinement may do next, worst first.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

// What a split that is not applied leaves on the screen, at most.
struct ScreenError {
  float quadric_px = 0.0F;
  float guaranteed_px = 0.0F;

  ScreenError() = default;
  ScreenError(const SplitNode& node, float scale_px)
      : quadric_px(in_pixels(node.error, scale_px)), guaranteed_px(in_pixels(node.guaranteed_error, scale_px)) {}
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

  // For heaps that pop the largest: highest priority first, ties by object and split, visits before applications.
  bool operator<(const Entry& o) const {
    if (priority != o.priority) return priority < o.priority;
    if (object != o.object) return object > o.object;
    if (split != o.split) return split > o.split;
    return kind > o.kind;
  }
};

// A heap that keeps its memory and lets its entries be looked through.
class Queue {
 public:
  [[nodiscard]] bool empty() const noexcept { return entries_.empty(); }
  [[nodiscard]] const Entry& top() const noexcept { return entries_.front(); }
  [[nodiscard]] std::span<const Entry> entries() const noexcept { return entries_; }
  void clear() noexcept { entries_.clear(); }
  void push(const Entry& entry) {
    entries_.push_back(entry);
    std::push_heap(entries_.begin(), entries_.end());
  }
  Entry pop() {
    std::pop_heap(entries_.begin(), entries_.end());
    const Entry entry = entries_.back();
    entries_.pop_back();
    return entry;
  }

 private:
  std::vector<Entry> entries_;
};

}  // namespace occlod
