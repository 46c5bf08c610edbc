#include "queue.h"

#include <cassert>

namespace occlod {

void Queue::clear() noexcept {
  nodes_.clear();
  free_ = none;
  size_ = 0;
  top_ = 0;
  for (std::size_t word = 0; word < occupied_.size(); ++word) {
    if (occupied_[word] == 0) continue;
    std::fill_n(first_.begin() + static_cast<std::ptrdiff_t>(word * word_bits), word_bits, none);
    occupied_[word] = 0;
  }
}

void Queue::push(const Entry& entry) {
  std::uint32_t at = free_;
  if (at != none) {
    free_ = nodes_[at].next;
  } else {
    at = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
  }
  const std::size_t bucket = bucket_of(entry);
  nodes_[at] = {entry, first_[bucket]};
  first_[bucket] = at;
  occupied_[bucket / word_bits] |= std::uint64_t{1} << (bucket % word_bits);
  if (size_ == 0 || bucket > top_) top_ = bucket;
  ++size_;
}

Entry Queue::pop() {
  assert(!empty());
  const std::uint32_t at = first_[top_];
  first_[top_] = nodes_[at].next;
  nodes_[at].next = free_;
  free_ = at;
  --size_;
  if (first_[top_] == none) {
    occupied_[top_ / word_bits] &= ~(std::uint64_t{1} << (top_ % word_bits));
    if (size_ > 0) find_top();
  }
  return nodes_[at].entry;
}

void Queue::find_top() noexcept {
  std::size_t word = top_ / word_bits;
  while (occupied_[word] == 0) --word;
  top_ = word * word_bits + static_cast<std::size_t>(std::bit_width(occupied_[word])) - 1;
}

}  // namespace occlod
