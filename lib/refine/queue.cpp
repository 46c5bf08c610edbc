#include "refine/queue.h"

#include <cassert>

namespace occlod {

void Queue::clear() noexcept {
  chunks_.clear();
  free_ = none;
  size_ = 0;
  top_ = 0;
  for (std::size_t word = 0; word < occupied_.size(); ++word) {
    if (occupied_[word] == 0) continue;
    std::fill_n(first_.begin() + static_cast<std::ptrdiff_t>(word * word_bits), word_bits, none);
    occupied_[word] = 0;
  }
}

std::uint32_t Queue::obtain_chunk(std::uint32_t below) {
  std::uint32_t at = free_;
  if (at != none) {
    free_ = chunks_[at].below;
  } else {
    at = static_cast<std::uint32_t>(chunks_.size());
    chunks_.emplace_back();
  }
  chunks_[at].size = 0;
  chunks_[at].below = below;
  return at;
}

Entry Queue::pop() {
  assert(!empty());
  std::uint32_t& first = first_[top_];
  Chunk& chunk = chunks_[first];
  const Entry entry = chunk.entries[--chunk.size];
  --size_;
  if (chunk.size > 0) return entry;
  const std::uint32_t emptied = first;
  first = chunk.below;
  chunk.below = free_;
  free_ = emptied;
  if (first == none) {
    occupied_[top_ / word_bits] &= ~(std::uint64_t{1} << (top_ % word_bits));
    if (size_ > 0) top_ = occupied_up_to(top_);
  }
  return entry;
}

std::size_t Queue::occupied_up_to(std::size_t bucket) const noexcept {
  std::size_t word = bucket / word_bits;
  std::uint64_t bits = occupied_[word] << (word_bits - 1 - bucket % word_bits);
  if (bits != 0) return bucket - static_cast<std::size_t>(std::countl_zero(bits));
  do --word;
  while (occupied_[word] == 0);
  return word * word_bits + static_cast<std::size_t>(std::bit_width(occupied_[word])) - 1;
}

}  // namespace occlod
