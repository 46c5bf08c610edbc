// Nodes that have been reached, the nearest first.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hlod/draw/node_state.h"

namespace occlod::hlod {

struct ReachedNode {
  double distance = 0.0;  // as ObjectFrame::distance()
  NodeRef ref;
  std::uint32_t place = 0;  // how many nodes were reached before it in this frame
};

// Ties by object, then by node, so coarse nodes first.
class DistanceQueue {
 public:
  void clear() noexcept { heap_.clear(); }
  [[nodiscard]] bool empty() const noexcept { return heap_.empty(); }
  void push(const ReachedNode& node) {
    heap_.push_back(node);
    std::push_heap(heap_.begin(), heap_.end(), comes_later);
  }
  [[nodiscard]] ReachedNode pop() {
    std::pop_heap(heap_.begin(), heap_.end(), comes_later);
    const ReachedNode node = heap_.back();
    heap_.pop_back();
    return node;
  }

 private:
  static bool comes_later(const ReachedNode& a, const ReachedNode& b) noexcept {
    if (a.distance != b.distance) return a.distance > b.distance;
    if (a.ref.object != b.ref.object) return a.ref.object > b.ref.object;
    return a.ref.node > b.ref.node;
  }

  std::vector<ReachedNode> heap_;
};

}  // namespace occlod::hlod
