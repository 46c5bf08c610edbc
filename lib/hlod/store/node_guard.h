// Lets an HLOD be used before all of it has been read: mesh and splits of each node are checked when they are first
// needed.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "occlod/hlod/hlod.h"

namespace occlod::hlod {

// Any number of threads may ask.
class NodeGuard {
 public:
  // `within_count`: of nodes whose splits are checked; none or all.
  NodeGuard(std::size_t node_count, std::size_t within_count) : checked_(node_count), within_checked_(within_count) {}
  NodeGuard(const NodeGuard&) = delete;
  NodeGuard& operator=(const NodeGuard&) = delete;
  virtual ~NodeGuard() = default;

  // Throws Error when the node's mesh is damaged, and marks it as checked otherwise.
  void check(NodeId n) {
    check_node(n);
    checked_[n].store(true, std::memory_order_release);
  }

  // The same for the node's splits.
  void check_within(NodeId n) {
    check_splits(n);
    within_checked_[n].store(true, std::memory_order_release);
  }

  // By node: what has been checked may be used by whoever has seen the mark.
  [[nodiscard]] const std::atomic<bool>* checked() const noexcept { return checked_.data(); }
  // Likewise; null when there are no splits.
  [[nodiscard]] const std::atomic<bool>* within_checked() const noexcept {
    return within_checked_.empty() ? nullptr : within_checked_.data();
  }

 private:
  virtual void check_node(NodeId n) = 0;
  virtual void check_splits(NodeId n) = 0;

  std::vector<std::atomic<bool>> checked_, within_checked_;
};

// Arrays that `owner` keeps alive, of which `guard` checks the parts of each node before they are used for the first
// time.
[[nodiscard]] Hlod guarded_hlod(const HlodView& view, std::shared_ptr<const void> owner,
                                std::shared_ptr<NodeGuard> guard);

}  // namespace occlod::hlod
