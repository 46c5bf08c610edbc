#include "papers/delimiter_code.h"

#include <bit>
#include <cstddef>

namespace occlod::paper {
namespace {

void write_number(BitString& bits, std::uint32_t number) {
  bool last = false, before_last = true;  // of what has been written; a lone 1 counts as after a 0
  bool in_pair = false;                   // the last bit is a 1 that no `11` has used
  for (int i = static_cast<int>(std::bit_width(number)) - 1; i >= 0; --i) {
    const bool bit = ((number >> i) & 1U) != 0;
    bits.push(bit);
    before_last = last;
    last = bit;
    if (bit && in_pair) {
      bits.push(false);
      before_last = true;
      last = false;
      in_pair = false;
    } else {
      in_pair = bit;
    }
  }
  if (last && !before_last) bits.push(true);
}

// Reads run of ones by run of ones.
class Decoder {
 public:
  explicit Decoder(const BitString& bits) : bits_(bits) {}

  std::vector<std::uint32_t> decode() {
    bool is_first = true;
    while (at_ < bits_.size()) {
      if (!bits_[at_]) {
        append(false);
        ++at_;
        continue;
      }
      const std::size_t begin = at_;
      while (at_ < bits_.size() && bits_[at_]) ++at_;
      const std::size_t ones = at_ - begin;
      if (at_ == bits_.size()) {
        finish(ones, is_first);
        return std::move(numbers_);
      }
      if (is_first) {
        const std::size_t start = ones % 4 == 1 ? 1 : 2;
        repeat_one((ones - start) / 4);
        begin_number(start);
        is_first = false;
      } else {
        read_ones(ones);
      }
    }
    if (!bits_.size()) return {};
    numbers_.push_back(current_);
    return std::move(numbers_);
  }

 private:
  void append(bool bit) { current_ = 2 * current_ + (bit ? 1 : 0); }
  void repeat_one(std::size_t times) { numbers_.insert(numbers_.end(), times, 1); }
  // With so many ones; after two follows a 0 that means nothing.
  void begin_number(std::size_t ones) {
    current_ = ones == 2 ? 3 : 1;
    if (ones == 2) ++at_;
  }
  void read_ones(std::size_t ones) {
    if (ones <= 2) {
      for (std::size_t i = 0; i < ones; ++i) append(true);
      if (ones == 2) ++at_;
      return;
    }
    // `end` ones of the number that ends here (the second is not its own), 2 between numbers, 4 for each number 1 with
    // what follows it, and `start` ones of the next number.
    const std::size_t end = ones % 4 == 1 || ones % 4 == 2 ? 2 : 0;
    const std::size_t start = ones % 4 == 1 || ones % 4 == 3 ? 1 : 2;
    if (end == 2) append(true);
    numbers_.push_back(current_);
    repeat_one((ones - end - 2 - start) / 4);
    begin_number(start);
  }
  void finish(std::size_t ones, bool is_first) {
    if (is_first) {
      repeat_one((ones + 2) / 4);
      return;
    }
    if (ones % 4 == 2) append(true);
    numbers_.push_back(current_);
    repeat_one(ones / 4);
  }

  const BitString& bits_;
  std::size_t at_ = 0;
  std::uint32_t current_ = 0;
  std::vector<std::uint32_t> numbers_;
};

}  // namespace

BitString encode_delimited(std::span<const std::uint32_t> numbers) {
  BitString bits;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0) {
      bits.push(true);
      bits.push(true);
    }
    write_number(bits, numbers[i]);
  }
  return bits;
}

std::vector<std::uint32_t> decode_delimited(const BitString& bits) { return Decoder(bits).decode(); }

}  // namespace occlod::paper
