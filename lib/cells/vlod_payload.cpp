#include "cells/vlod_payload.h"

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>

namespace occlod {
namespace {

constexpr unsigned number_bits = 40;
constexpr unsigned tag_bits = 4;
constexpr unsigned varint_bits = 7;  // in a group; one more bit tells whether another group follows

unsigned gamma_bits(std::uint64_t value) { return 2 * static_cast<unsigned>(std::bit_width(value + 1)) - 1; }
unsigned varint_groups(std::uint64_t value) {
  return value == 0 ? 1 : (static_cast<unsigned>(std::bit_width(value)) + varint_bits - 1) / varint_bits;
}

// Returns the size in bits under each code, by tag.
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

// Returns 2^40 where the number is too large.
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
  if (count > reader.bits_left()) return false;  // every number takes at least one bit
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

namespace occlod::vlod {
namespace {

using Set = std::vector<std::uint64_t>;

// Writes the places of known splits, then the other splits.
void put_splits(BitWriter& writer, std::span<const std::uint64_t> splits, std::span<const std::uint64_t> known) {
  Set places, rest;
  auto at = known.begin();
  for (const std::uint64_t s : splits) {
    at = std::lower_bound(at, known.end(), s);
    if (at != known.end() && *at == s)
      places.push_back(static_cast<std::uint64_t>(at - known.begin()));
    else
      rest.push_back(s);
  }
  put_set(writer, places);
  put_set(writer, rest);
}

// Reads `count` splits, all below `end`.
bool get_splits(BitReader& reader, std::uint64_t end, std::size_t count, std::span<const std::uint64_t> known,
                Set& splits) {
  Set places, rest;
  if (!get_set(reader, known.size(), count, places) || !get_set(reader, end, count - places.size(), rest)) return false;
  if (places.size() + rest.size() != count) return false;
  for (std::uint64_t& place : places) place = known[place];
  std::merge(places.begin(), places.end(), rest.begin(), rest.end(), std::back_inserter(splits));
  return std::adjacent_find(splits.begin(), splits.end()) == splits.end();
}

Set without(std::span<const std::uint64_t> set, const Set& left_out) {
  Set result;
  std::set_difference(set.begin(), set.end(), left_out.begin(), left_out.end(), std::back_inserter(result));
  return result;
}

// Writes faces as their owners, the number of faces of each minus one, and their slots, each as the gap to the one
// before.
void put_faces(BitWriter& writer, std::span<const std::uint64_t> faces) {
  std::vector<std::uint64_t> owners, counts, slots;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const std::uint64_t owner = faces[i] >> 32U, slot = faces[i] & 0xFFFFFFFFU;
    if (owners.empty() || owners.back() != owner) {
      owners.push_back(owner);
      counts.push_back(0);
      slots.push_back(slot);
    } else {
      ++counts.back();
      slots.push_back(slot - (faces[i - 1] & 0xFFFFFFFFU) - 1);
    }
  }
  put_set(writer, owners);
  put_numbers(writer, counts);
  put_numbers(writer, slots);
}

bool get_faces(BitReader& reader, const Expected& expected, std::vector<std::uint64_t>& faces) {
  std::vector<std::uint64_t> owners, counts, slots;
  if (!get_set(reader, expected.owner_count, expected.hidden, owners)) return false;
  if (!get_numbers(reader, owners.size(), counts) || !get_numbers(reader, expected.hidden, slots)) return false;
  std::size_t next = 0;
  for (std::size_t i = 0; i < owners.size(); ++i) {
    if (counts[i] >= slots.size() - next) return false;
    std::uint64_t slot = 0;
    for (std::uint64_t k = 0; k <= counts[i]; ++k, ++slot) {
      slot += slots[next++];
      if (slot >> 32U != 0) return false;
      faces.push_back(owners[i] << 32U | slot);
    }
  }
  return next == slots.size();
}

}  // namespace

std::vector<std::byte> encode(const Additions& additions, std::span<const std::uint64_t> known,
                              std::uint32_t max_ids_per_byte) {
  BitWriter writer;
  put_splits(writer, additions.splits, known);
  put_splits(writer, additions.candidates, without(known, additions.splits));
  put_faces(writer, additions.hidden);
  std::vector<std::byte> bytes = writer.take();
  const std::size_t ids = additions.splits.size() + additions.candidates.size() + additions.hidden.size();
  bytes.resize(std::max(bytes.size(), (ids + max_ids_per_byte - 1) / max_ids_per_byte));
  return bytes;
}

std::optional<Additions> decode(std::span<const std::byte> bytes, const Expected& expected,
                                std::span<const std::uint64_t> known, std::string& problem) {
  Additions additions;
  BitReader reader(bytes);
  if (!get_splits(reader, expected.split_count, expected.splits, known, additions.splits))
    problem = "does not hold the splits that it says";
  else if (!get_splits(reader, expected.split_count, expected.candidates, without(known, additions.splits),
                       additions.candidates))
    problem = "does not hold the candidates that it says";
  else if (!get_faces(reader, expected, additions.hidden))
    problem = "does not hold the faces that it says";
  else if (!reader.rest_is_zero())
    problem = "holds more than it says";
  else
    return additions;
  return {};
}

}  // namespace occlod::vlod
