// A queue of vertices by the cost of their collapses, exact to some per cent.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace occlod {

// Items are small numbers, each there at most once. Costs fall into levels of 1/32 octave; within a level the last to
// come is the first to go. Every operation takes constant time, but for the search of the next level that is not empty.
class CollapseQueue {
 public:
  // Empties the queue, for items in [0, count).
  void reset(std::size_t count) {
    links_.assign(count, {});
    heads_.fill(none);
    cursor_ = level_count;
  }

  [[nodiscard]] static std::uint32_t level(float cost) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(cost) >> 18;
    return std::clamp(bits, lowest_bits, highest_bits) - lowest_bits;
  }

  // The item is not in the queue. cost >= 0.
  void push(std::uint32_t item, float cost) {
    const std::uint32_t at = level(cost);
    links_[item] = {none, heads_[at], at};
    if (heads_[at] != none) links_[heads_[at]].before = item;
    heads_[at] = item;
    cursor_ = std::min(cursor_, at);
  }

  void remove(std::uint32_t item) {
    Link& link = links_[item];
    if (link.level == none) return;
    (link.before == none ? heads_[link.level] : links_[link.before].after) = link.after;
    if (link.after != none) links_[link.after].before = link.before;
    link.level = none;
  }

  // The cheapest item, or `none` when there is none; it leaves the queue.
  std::uint32_t pop() {
    while (cursor_ < level_count && heads_[cursor_] == none) ++cursor_;
    if (cursor_ >= level_count) return none;
    const std::uint32_t item = heads_[cursor_];
    remove(item);
    return item;
  }

  // Most likely the next item to pop; `none` when unknown.
  [[nodiscard]] std::uint32_t likely_next() const { return cursor_ < level_count ? heads_[cursor_] : none; }
  // Most likely the one to pop after that item.
  [[nodiscard]] std::uint32_t likely_after(std::uint32_t item) const { return links_[item].after; }

  static constexpr std::uint32_t none = UINT32_MAX;

 private:
  struct Link {
    std::uint32_t before = none, after = none;  // in the same level
    std::uint32_t level = none;                 // none: not in the queue
  };
  static constexpr std::uint32_t lowest_bits = (127U - 80U) << 5, highest_bits = (127U + 8U) << 5;  // 2^-80 to 2^8
  static constexpr std::uint32_t level_count = highest_bits - lowest_bits + 1;

  std::vector<Link> links_;
  std::array<std::uint32_t, level_count> heads_{};
  std::uint32_t cursor_ = level_count;
};

}  // namespace occlod
