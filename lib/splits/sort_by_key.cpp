#include "splits/sort_by_key.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "splits/parallel.h"

namespace occlod {

// Each thread has a part of the items: with parts in order within each digit, their number does not change the result.
void sort_by_key(UninitializedVector<Keyed>& items, unsigned key_bits, unsigned threads) {
  if (items.empty()) return;
  const unsigned rounds = std::max(1U, (key_bits + 10) / 11), digit_bits = (key_bits + rounds - 1) / rounds;
  const std::size_t digits = std::size_t{1} << digit_bits;
  UninitializedVector<Keyed> other(items.size());
  std::vector<std::size_t> starts(threads * digits);
  for (unsigned round = 0; round < rounds; ++round) {
    const auto digit_of = [&](const Keyed& item) { return item.key >> (round * digit_bits) & (digits - 1); };
    std::fill(starts.begin(), starts.end(), 0);
    for_each_part(items.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t part) {
      std::size_t* const counts = starts.data() + part * digits;
      for_each_short_range(begin, end, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) ++counts[digit_of(items[i])];
      });
    });
    std::size_t sum = 0;
    for (std::size_t digit = 0; digit < digits; ++digit)
      for (unsigned t = 0; t < threads; ++t) sum += std::exchange(starts[t * digits + digit], sum);
    for_each_part(items.size(), threads, [&](std::size_t begin, std::size_t end, std::size_t part) {
      std::size_t* const next = starts.data() + part * digits;
      for_each_short_range(begin, end, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) other[next[digit_of(items[i])]++] = items[i];
      });
    });
    items.swap(other);
  }
}

}  // namespace occlod
