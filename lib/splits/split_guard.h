// Lets a hierarchy be used before all of it has been read: each block of splits is checked when it is first needed.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

// Blocks are runs of splits. Any number of threads may ask.
class SplitGuard {
 public:
  static constexpr std::uint32_t block_bits = 10;
  static constexpr std::size_t block_size = std::size_t{1} << block_bits;

  explicit SplitGuard(std::size_t split_count) : checked_((split_count + block_size - 1) / block_size) {}
  SplitGuard(const SplitGuard&) = delete;
  SplitGuard& operator=(const SplitGuard&) = delete;
  virtual ~SplitGuard() = default;

  // Throws Error when the block is damaged, and marks it as checked otherwise.
  void check(std::size_t block) {
    check_block(block);
    checked_[block].store(true, std::memory_order_release);
  }

  [[nodiscard]] std::size_t block_count() const noexcept { return checked_.size(); }
  // By block: what has been checked may be used by whoever has seen the mark.
  [[nodiscard]] const std::atomic<bool>* checked() const noexcept { return checked_.data(); }

 private:
  virtual void check_block(std::size_t block) = 0;

  std::vector<std::atomic<bool>> checked_;
};

// Arrays that `owner` keeps alive, of which `guard` checks each block before it is used for the first time.
[[nodiscard]] Hierarchy guarded_hierarchy(const HierarchyView& view, std::shared_ptr<const void> owner,
                                          std::shared_ptr<SplitGuard> guard);

}  // namespace occlod
