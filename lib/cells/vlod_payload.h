// Packs numbers of different bit widths one after the other.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace occlod {

// Writes from the lowest bit of each byte up.
class BitWriter {
 public:
  // Writes the lowest `count` <= 57 bits of `bits`; the bits above must be 0.
  void put(std::uint64_t bits, unsigned count) {
    pending_ |= bits << pending_count_;
    pending_count_ += count;
    for (; pending_count_ >= 8; pending_count_ -= 8, pending_ >>= 8U) bytes_.push_back(std::byte(pending_ & 0xFFU));
  }
  // Writes `zeros` zero bits and a one.
  void put_unary(std::uint64_t zeros) {
    for (; zeros >= 32; zeros -= 32) put(0, 32);
    put(std::uint64_t{1} << zeros, static_cast<unsigned>(zeros) + 1);
  }
  // Writes the Elias gamma code of value >= 1.
  void put_gamma(std::uint64_t value) {
    const auto low_bits = static_cast<unsigned>(std::bit_width(value)) - 1;
    put_unary(low_bits);
    put(value ^ (std::uint64_t{1} << low_bits), low_bits);
  }
  // Returns everything written, padded with zeros to whole bytes.
  [[nodiscard]] std::vector<std::byte> take() {
    if (pending_count_ > 0) bytes_.push_back(std::byte(pending_));
    pending_ = pending_count_ = 0;
    return std::move(bytes_);
  }

 private:
  std::vector<std::byte> bytes_;
  std::uint64_t pending_ = 0;
  unsigned pending_count_ = 0;  // < 8 between calls
};

// Reads what a BitWriter wrote. Past the end it returns zeros, and failed() is true from then on.
class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

  // Reads `count` <= 57 bits.
  [[nodiscard]] std::uint64_t get(unsigned count) noexcept {
    fill(count);
    const std::uint64_t bits = pending_ & ((std::uint64_t{1} << count) - 1);
    pending_ >>= count;
    pending_count_ -= count;
    return bits;
  }
  [[nodiscard]] std::uint64_t get_unary() noexcept {
    std::uint64_t zeros = 0;
    while (!failed_) {
      fill(1);
      if (pending_ != 0) {
        const auto here = static_cast<unsigned>(std::countr_zero(pending_));
        pending_ >>= here + 1;
        pending_count_ -= here + 1;
        return zeros + here;
      }
      zeros += pending_count_;
      pending_count_ = 0;
    }
    return zeros;
  }
  [[nodiscard]] std::uint64_t get_gamma() noexcept {
    const std::uint64_t low_bits = get_unary();
    if (low_bits > 56) {
      failed_ = true;
      return 1;
    }
    return get(static_cast<unsigned>(low_bits)) | (std::uint64_t{1} << low_bits);
  }
  // Returns whether more was read than available, or a number was too large.
  [[nodiscard]] bool failed() const noexcept { return failed_; }
  // Returns the number of bits not yet read.
  [[nodiscard]] std::uint64_t bits_left() const noexcept { return 8 * (bytes_.size() - at_) + pending_count_; }
  // Returns whether only zeros are left.
  [[nodiscard]] bool rest_is_zero() const noexcept {
    if (pending_ != 0) return false;
    for (std::size_t i = at_; i < bytes_.size(); ++i)
      if (bytes_[i] != std::byte{0}) return false;
    return true;
  }

 private:
  // Invariant: bits of pending_ at pending_count_ and above are 0.
  void fill(unsigned count) noexcept {
    while (pending_count_ < count) {
      if (at_ == bytes_.size()) {
        failed_ = true;
        pending_count_ = count;
        return;
      }
      pending_ |= std::to_integer<std::uint64_t>(bytes_[at_++]) << pending_count_;
      pending_count_ += 8;
    }
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint64_t pending_ = 0;
  unsigned pending_count_ = 0;
  bool failed_ = false;
};

// Encodes sets of numbers compactly as runs, whose gaps and lengths are each coded in the shortest available way.

// Tags of the codes for a sequence of numbers; the tag, 4 bits, precedes them. 0 to 13 are Rice codes, whose tag is the
// number of low bits that are written verbatim, after the rest in unary. (Golomb 1966, Rice 1979; Elias 1975.)
inline constexpr unsigned rice_codes = 14, gamma_tag = 14, varint_tag = 15;

// Writes numbers < 2^40 with the code that takes the fewest bits; ties go to the smallest tag. O(numbers * codes).
void put_numbers(BitWriter& writer, std::span<const std::uint64_t> numbers);
// Reads `count` numbers. Returns false when there are fewer, or one is >= 2^40.
[[nodiscard]] bool get_numbers(BitReader& reader, std::size_t count, std::vector<std::uint64_t>& numbers);

// Writes a set of ascending, distinct numbers < 2^40: the number of runs, then gaps, then lengths.
void put_set(BitWriter& writer, std::span<const std::uint64_t> set);
// Appends a set of numbers < end to `set`. Returns false when it is damaged, reaches beyond `end`, or has more than
// `most` elements; `set` has then received at most that many.
[[nodiscard]] bool get_set(BitReader& reader, std::uint64_t end, std::size_t most, std::vector<std::uint64_t>& set);

}  // namespace occlod

namespace occlod::vlod {

// Encodes what a node of the tree of cells adds.

// Holds ascending numbers of GlobalIds.
struct Additions {
  std::vector<std::uint64_t> splits;
  std::vector<std::uint64_t> candidates;  // splits; none of them is added
  std::vector<std::uint64_t> hidden;      // faces: owner << 32 | slot
};

// Encodes additions. Splits that are in `known` (ascending; the candidates of the node above) are coded as places
// there, which takes about half the bits. The result is padded with zeros so that no byte has more than
// `max_ids_per_byte` ids.
[[nodiscard]] std::vector<std::byte> encode(const Additions& additions, std::span<const std::uint64_t> known,
                                            std::uint32_t max_ids_per_byte);

// Holds the counts that encoded data must have.
struct Expected {
  std::uint64_t split_count = 0, owner_count = 0;      // of GlobalIds
  std::size_t splits = 0, candidates = 0, hidden = 0;  // numbers of elements
};
// Decodes additions. Returns nothing, and describes the problem in `problem`, when the bytes do not contain what is
// expected.
[[nodiscard]] std::optional<Additions> decode(std::span<const std::byte> bytes, const Expected& expected,
                                              std::span<const std::uint64_t> known, std::string& problem);

}  // namespace occlod::vlod
