#include "gl/range_allocator.h"

#include <cassert>
#include <iterator>

namespace occlod::gl {

RangeAllocator::RangeAllocator(std::size_t size) : size_(size) {
  if (size > 0) gaps_.emplace(0, size);
}

std::optional<std::size_t> RangeAllocator::take(std::size_t count) {
  assert(count > 0);
  auto best = gaps_.end();
  for (auto gap = gaps_.begin(); gap != gaps_.end(); ++gap)
    if (gap->second >= count && (best == gaps_.end() || gap->second < best->second)) best = gap;
  if (best == gaps_.end()) return std::nullopt;
  const auto [first, free] = *best;
  gaps_.erase(best);
  if (free > count) gaps_.emplace(first + count, free - count);
  return first;
}

void RangeAllocator::give_back(std::size_t first, std::size_t count) {
  assert(count > 0 && first + count <= size_);
  auto gap = gaps_.emplace(first, count).first;
  const auto next = std::next(gap);
  assert(next == gaps_.end() || first + count <= next->first);
  if (next != gaps_.end() && next->first == first + count) {
    gap->second += next->second;
    gaps_.erase(next);
  }
  if (gap == gaps_.begin()) return;
  const auto before = std::prev(gap);
  assert(before->first + before->second <= first);
  if (before->first + before->second != first) return;
  before->second += gap->second;
  gaps_.erase(gap);
}

}  // namespace occlod::gl
