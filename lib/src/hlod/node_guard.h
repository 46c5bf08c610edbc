// Lets an HLOD be used before all of it has been read: the mesh of each node is checked when it is first needed.
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
  explicit NodeGuard(std::size_t node_count) : checked_(node_count) {}
  NodeGuard(const NodeGuard&) = delete;
  NodeGuard& operator=(const NodeGuard&) = delete;
  virtual ~NodeGuard() = default;

  // Throws Error when the node's mesh is damaged, and marks it as checked otherwise.
  void check(NodeId n) {
    check_node(n);
    checked_[n].store(true, std::memory_order_release);
  }

  // By node: what has been checked may be used by whoever has seen the mark.
  [[nodiscard]] const std::atomic<bool>* checked() const noexcept { return checked_.data(); }

 private:
  virtual void check_node(NodeId n) = 0;

  std::vector<std::atomic<bool>> checked_;
};

// Arrays that `owner` keeps alive, of which `guard` checks each mesh before it is used for the first time.
[[nodiscard]] Hlod guarded_hlod(const HlodView& view, std::shared_ptr<const void> owner,
                                std::shared_ptr<NodeGuard> guard);

}  // namespace occlod::hlod
