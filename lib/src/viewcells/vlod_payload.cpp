#include "viewcells/vlod_payload.h"

#include "viewcells/set_code.h"
#include "viewcells/vlod_format.h"

namespace occlod::vlod {
namespace {

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

std::vector<std::byte> encode(const Additions& additions) {
  BitWriter writer;
  put_set(writer, additions.splits);
  put_faces(writer, additions.hidden);
  std::vector<std::byte> bytes = writer.take();
  const std::size_t least =
      (additions.splits.size() + additions.hidden.size() + most_ids_per_byte - 1) / most_ids_per_byte;
  if (bytes.size() < least) bytes.resize(least);
  return bytes;
}

std::optional<Additions> decode(std::span<const std::byte> bytes, const Expected& expected, std::string& problem) {
  Additions additions;
  BitReader reader(bytes);
  if (!get_set(reader, expected.split_count, expected.splits, additions.splits) ||
      additions.splits.size() != expected.splits) {
    problem = "does not hold the splits that it says";
    return {};
  }
  if (!get_faces(reader, expected, additions.hidden)) {
    problem = "does not hold the faces that it says";
    return {};
  }
  if (!reader.rest_is_zero()) {
    problem = "holds more than it says";
    return {};
  }
  return additions;
}

}  // namespace occlod::vlod
