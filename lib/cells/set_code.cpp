#include "cells/set_code.h"

#include <array>
#include <bit>

namespace occlod {
namespace {

constexpr unsigned number_bits = 40;
constexpr unsigned tag_bits = 4;
constexpr unsigned varint_bits = 7;  // in a group; one more says whether another group follows

unsigned gamma_bits(std::uint64_t value) { return 2 * static_cast<unsigned>(std::bit_width(value + 1)) - 1; }
unsigned varint_groups(std::uint64_t value) {
  return value == 0 ? 1 : (static_cast<unsigned>(std::bit_width(value)) + varint_bits - 1) / varint_bits;
}

// Of all codes, by tag.
std::array<std::uint64_t, 16> bits_of(std::span<const std::uint64_t> numbers) {
  std::array<std::uint64_t, 16> bits{};
  for (const std::uint64_t n : numbers) {
    for (unsigned k = 0; k < rice_codes; ++k) bits[k] += (n >> k) + 1 + k;
    bits[gamma_tag] += gamma_bits(n);
    bits[varint_tag] += std::uint64_t{varint_bits + 1} * varint_groups(n);
  }
  return bits;
}

void put_varint(BitWriter& writer, std::uint64_t value) {
  for (unsigned groups = varint_groups(value); groups > 0; --groups, value >>= varint_bits) {
    writer.put(value & ((1U << varint_bits) - 1), varint_bits);
    writer.put(groups > 1 ? 1 : 0, 1);
  }
}

// 2^40 where it is too large.
std::uint64_t get_varint(BitReader& reader) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < number_bits; shift += varint_bits) {
    value |= reader.get(varint_bits) << shift;
    if (reader.get(1) == 0) return value;
  }
  return std::uint64_t{1} << number_bits;
}

std::uint64_t get_number(BitReader& reader, unsigned tag) {
  if (tag == gamma_tag) return reader.get_gamma() - 1;
  if (tag == varint_tag) return get_varint(reader);
  const std::uint64_t high = reader.get_unary();
  return (high << tag) | reader.get(tag);
}

}  // namespace

void put_numbers(BitWriter& writer, std::span<const std::uint64_t> numbers) {
  const std::array<std::uint64_t, 16> bits = bits_of(numbers);
  unsigned tag = 0;
  for (unsigned t = 1; t < bits.size(); ++t)
    if (bits[t] < bits[tag]) tag = t;
  writer.put(tag, tag_bits);
  for (const std::uint64_t n : numbers) {
    if (tag == gamma_tag) {
      writer.put_gamma(n + 1);
    } else if (tag == varint_tag) {
      put_varint(writer, n);
    } else {
      writer.put_unary(n >> tag);
      writer.put(n & ((std::uint64_t{1} << tag) - 1), tag);
    }
  }
}

bool get_numbers(BitReader& reader, std::size_t count, std::vector<std::uint64_t>& numbers) {
  numbers.clear();
  const auto tag = static_cast<unsigned>(reader.get(tag_bits));
  if (count > reader.bits_left()) return false;  // every number takes a bit at least
  for (std::size_t i = 0; i < count; ++i) {
    numbers.push_back(get_number(reader, tag));
    if (reader.failed() || numbers.back() >> number_bits != 0) return false;
  }
  return !reader.failed();
}

void put_set(BitWriter& writer, std::span<const std::uint64_t> set) {
  std::vector<std::uint64_t> gaps, lengths;
  for (std::size_t i = 0; i < set.size();) {
    std::size_t end = i + 1;
    while (end < set.size() && set[end] == set[end - 1] + 1) ++end;
    gaps.push_back(i == 0 ? set[0] : set[i] - set[i - 1] - 2);  // at least one number lies between two runs
    lengths.push_back(end - i - 1);
    i = end;
  }
  writer.put_gamma(gaps.size() + 1);
  if (gaps.empty()) return;
  put_numbers(writer, gaps);
  put_numbers(writer, lengths);
}

bool get_set(BitReader& reader, std::uint64_t end, std::size_t most, std::vector<std::uint64_t>& set) {
  const std::uint64_t runs = reader.get_gamma() - 1;
  if (reader.failed()) return false;
  if (runs == 0) return true;
  std::vector<std::uint64_t> gaps, lengths;
  if (!get_numbers(reader, runs, gaps) || !get_numbers(reader, runs, lengths)) return false;
  std::uint64_t at = 0;
  for (std::size_t i = 0; i < runs; ++i) {
    at += gaps[i] + (i == 0 ? 0 : 1);
    const std::uint64_t length = lengths[i] + 1;
    if (at >= end || length > end - at || length > most) return false;
    most -= length;
    for (std::uint64_t k = 0; k < length; ++k) set.push_back(at + k);
    at += length;
  }
  return true;
}

}  // namespace occlod
