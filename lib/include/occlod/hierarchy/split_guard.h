// Lets a hierarchy be used before all of it has been read: each block of splits is checked when it is first needed.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "occlod/core/ids.h"

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

  // Checks the block of split s unless that has been done. Throws Error when the block is damaged.
  void require(SplitId s) {
    std::atomic<bool>& checked = checked_[s >> block_bits];
    if (checked.load(std::memory_order_acquire)) return;
    check_block(s >> block_bits);
    checked.store(true, std::memory_order_release);
  }

  [[nodiscard]] std::size_t block_count() const noexcept { return checked_.size(); }

 private:
  virtual void check_block(std::size_t block) = 0;

  std::vector<std::atomic<bool>> checked_;
};

}  // namespace occlod
