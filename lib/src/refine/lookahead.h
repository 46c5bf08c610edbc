// Weighs what will soon come out of a queue, many at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "occlod/hierarchy/hierarchy.h"
#include "priority/queue.h"
#include "refine/refined_scene.h"

namespace occlod {

// Nodes are weighed when refinement descends to them, each where it lies in memory. But a node's weight depends on
// nothing that refinement does, and what will be descended next is known nearly always: what is on top of the queue. So
// when the children of one entry are weighed, those of the next entries are weighed with them, in vectors. What has
// been looked at in vain is only what the budget ends before.
class Lookahead {
 public:
  void begin(const RefinedScene& scene) {
    const RefineOptions* const options = scene.options;
    scene_ = scene;
    looks_at_stars_ = options->priority.culling == Culling::star;
  }

  // Sets child_scales_px of an entry of kind `visit` that has none, and of entries of the queue. Throws Error when a
  // child is damaged.
  void weigh_children(Entry& entry, Queue& queue);
  // What weigh_splits() tells of each.
  void weigh(std::uint32_t object, std::span<const SplitId> splits, std::span<float> scales_px);

 private:
  static constexpr std::size_t batch_size = 32;    // nodes, two for each entry
  static constexpr std::size_t lanes = 8;          // of vectors, or a multiple of that
  static constexpr std::size_t most_entries = 28;  // looked at to fill a batch

  void gather(Entry& entry, Queue& queue);
  void prefetch_star(const Entry& entry) const;
  void prefetch_corners(const Entry& entry) const;

  RefinedScene scene_;
  bool looks_at_stars_ = false;
  std::size_t size_ = 0;  // entries
  std::array<Entry*, batch_size / 2> entries_{};
  std::array<SplitId, batch_size> splits_{};
  std::array<SplitNode, batch_size> nodes_{};
};

}  // namespace occlod
