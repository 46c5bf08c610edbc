#include "cells/vlod_payload.h"

#include <algorithm>
#include <iterator>

#include "cells/set_code.h"

namespace occlod::vlod {
namespace {

using Set = std::vector<std::uint64_t>;

// Places of what is known, then the rest.
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

// `end`: of their numbers; `count`: of them.
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

// Faces as what they belong to, how many each has, less one, and their slots: each the gap to the one before.
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
                              std::uint32_t most_ids_per_byte) {
  BitWriter writer;
  put_splits(writer, additions.splits, known);
  put_splits(writer, additions.candidates, without(known, additions.splits));
  put_faces(writer, additions.hidden);
  std::vector<std::byte> bytes = writer.take();
  const std::size_t ids = additions.splits.size() + additions.candidates.size() + additions.hidden.size();
  bytes.resize(std::max(bytes.size(), (ids + most_ids_per_byte - 1) / most_ids_per_byte));
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
