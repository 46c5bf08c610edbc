// Queues what refinement may do next.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/memory.h"
#include "occlod/base.h"
#include "refine/screen_error.h"

namespace occlod {

struct Entry {
  enum class Kind : std::uint8_t {
    visit,  // visit a node: descend below it
    apply,  // apply the split itself
  };
  float priority = 0.0F;  // quadric screen error in pixels, weighted
  ScreenError error;      // unweighted error
  SplitId split = no_id;
  std::uint32_t object = 0;
  std::uint32_t level = 0;           // level of the split in the forest, 0 at roots
  std::uint32_t asked_occluder = 0;  // number of the occluder that did not hide it when last asked; 0 = never asked
  Kind kind = Kind::visit;
  bool weighed = false;     // whether priority includes what the split forces
  bool star_shows = false;  // whether that occluder does not hide the split's own star either
  bool covered = false;     // whether priority includes Tuning::covered_factor
};

// Holds entries, worst first, to within a sixty-fourth of a factor of two; of entries that are as bad, the last one in
// comes out first, which has just been looked at. Pushing and popping take constant time, where a heap would miss the
// caches all along its height; entries that follow each other are side by side in memory, a few at a time. Keeps its
// memory.
class Queue {
 public:
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] const Entry& top() const noexcept {
    const Chunk& chunk = chunks_[first_[top_]];
    return chunk.entries[chunk.size - 1];
  }
  // Returns the band of the top. Bands are a sixteenth of a factor of two, higher ones first. Precondition: the queue
  // is not empty.
  [[nodiscard]] std::size_t top_band() const noexcept { return top_ >> band_bits; }
  [[nodiscard]] static std::size_t band_of(const Entry& entry) noexcept { return bucket_of(entry) >> band_bits; }
  // Returns whether a may come out before b or is about as bad.
  [[nodiscard]] static bool may_precede(const Entry& a, const Entry& b) noexcept {
    return bucket_of(a) >= bucket_of(b);
  }
  // Returns whether the entry would come out before all others.
  [[nodiscard]] bool would_be_next(const Entry& entry) const noexcept { return empty() || bucket_of(entry) >= top_; }

  void clear() noexcept;
  void push(const Entry& entry);
  Entry pop();

  // Calls visit(const Entry&) for each.
  template <typename Visit>
  void for_each(const Visit& visit) const;

 private:
  struct alignas(64) Chunk {
    static constexpr std::uint32_t capacity = 7;
    std::array<Entry, capacity> entries;
    std::uint32_t size = 0;
    std::uint32_t below = none;  // next chunk in its bucket, which is full, or in the list of free ones
  };
  static_assert(sizeof(Chunk) == 256, "whole cache lines");
  static constexpr std::uint32_t none = no_id;
  static constexpr int dropped_bits = 17;  // bits of a float that are dropped: its exponent and six bits of its
                                           // mantissa are left
  static constexpr std::size_t bucket_count = std::size_t{1} << (31 - dropped_bits);
  static constexpr std::size_t word_bits = 64;
  static constexpr int band_bits = 2;  // bits of a bucket's number that bands drop

  static std::size_t bucket_of(const Entry& entry) noexcept {
    return entry.priority > 0.0F ? std::bit_cast<std::uint32_t>(entry.priority) >> dropped_bits : 0;
  }
  std::uint32_t obtain_chunk(std::uint32_t below);
  // Returns the highest bucket up to `bucket` that is not empty. Precondition: there is one.
  [[nodiscard]] std::size_t occupied_up_to(std::size_t bucket) const noexcept;

  LargeVector<Chunk> chunks_;
  std::uint32_t free_ = none;
  std::size_t size_ = 0;
  std::size_t top_ = 0;  // highest bucket that is not empty, if any is
  std::vector<std::uint32_t> first_ = std::vector<std::uint32_t>(bucket_count, none);
  std::array<std::uint64_t, bucket_count / word_bits> occupied_{};  // one bit per bucket
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

template <typename Visit>
void Queue::for_each(const Visit& visit) const {
  std::size_t left = size_;
  for (std::size_t bucket = top_; left > 0; --bucket) {
    bucket = occupied_up_to(bucket);
    for (std::uint32_t at = first_[bucket]; at != none; at = chunks_[at].below) {
      left -= chunks_[at].size;
      for (std::uint32_t i = chunks_[at].size; i-- > 0;) visit(chunks_[at].entries[i]);
    }
  }
}

}  // namespace occlod
