// What refinement may do next, worst first.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/large_vector.h"
#include "priority/entry.h"

namespace occlod {

// Worst first, to within a sixty-fourth of a factor of two; of entries that are as bad, the last one in comes out
// first, which has just been looked at. Pushing and popping take constant time where a heap's would miss the caches all
// along its height; entries that follow each other are side by side in memory, a few at a time. Keeps its memory.
class Queue {
 public:
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] const Entry& top() const noexcept {
    const Chunk& chunk = chunks_[first_[top_]];
    return chunk.entries[chunk.size - 1];
  }
  // Whether it would come out before all others.
  [[nodiscard]] bool would_be_next(const Entry& entry) const noexcept { return empty() || bucket_of(entry) >= top_; }

  void clear() noexcept;
  void push(const Entry& entry);
  Entry pop();

  // Calls visit(const Entry&) for each.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    for_top([&](const Entry& entry) {
      visit(entry);
      return true;
    });
  }
  // Calls visit(Entry&) in the order in which they would come out, until it returns false. Priorities must stay.
  template <typename Visit>
  void for_top(const Visit& visit) {
    for_top_of(*this, visit);
  }
  template <typename Visit>
  void for_top(const Visit& visit) const {
    for_top_of(*this, visit);
  }

 private:
  struct alignas(64) Chunk {
    static constexpr std::uint32_t capacity = 6;
    std::array<Entry, capacity> entries;
    std::uint32_t size = 0;
    std::uint32_t below = none;  // in its bucket, full; or in the list of free ones
  };
  static_assert(sizeof(Chunk) == 256, "whole cache lines");
  static constexpr std::uint32_t none = no_id;
  static constexpr int dropped_bits = 17;  // of a float: its exponent and six bits of its mantissa are left
  static constexpr std::size_t bucket_count = std::size_t{1} << (31 - dropped_bits);
  static constexpr std::size_t word_bits = 64;

  static std::size_t bucket_of(const Entry& entry) noexcept {
    return entry.priority > 0.0F ? std::bit_cast<std::uint32_t>(entry.priority) >> dropped_bits : 0;
  }
  std::uint32_t obtain_chunk(std::uint32_t below);
  template <typename Self, typename Visit>
  static void for_top_of(Self& queue, const Visit& visit);
  // The highest bucket up to `bucket` that is not empty. Precondition: there is one.
  [[nodiscard]] std::size_t occupied_up_to(std::size_t bucket) const noexcept;

  LargeVector<Chunk> chunks_;
  std::uint32_t free_ = none;
  std::size_t size_ = 0;
  std::size_t top_ = 0;  // the highest bucket that is not empty, if any is
  std::vector<std::uint32_t> first_ = std::vector<std::uint32_t>(bucket_count, none);
  std::array<std::uint64_t, bucket_count / word_bits> occupied_{};  // a bit for each bucket
};

inline void Queue::push(const Entry& entry) {
  const std::size_t bucket = bucket_of(entry);
  std::uint32_t& first = first_[bucket];
  if (first == none || chunks_[first].size == Chunk::capacity) first = obtain_chunk(first);
  Chunk& chunk = chunks_[first];
  chunk.entries[chunk.size++] = entry;
  occupied_[bucket / word_bits] |= std::uint64_t{1} << (bucket % word_bits);
  if (size_ == 0 || bucket > top_) top_ = bucket;
  ++size_;
}

template <typename Self, typename Visit>
void Queue::for_top_of(Self& queue, const Visit& visit) {
  if (queue.empty()) return;
  std::size_t left = queue.size_;
  for (std::size_t bucket = queue.top_;; bucket = queue.occupied_up_to(bucket - 1)) {
    for (std::uint32_t at = queue.first_[bucket]; at != none; at = queue.chunks_[at].below) {
      left -= queue.chunks_[at].size;
      for (std::uint32_t i = queue.chunks_[at].size; i-- > 0;)
        if (!visit(queue.chunks_[at].entries[i])) return;
    }
    if (left == 0) return;
  }
}

}  // namespace occlod
