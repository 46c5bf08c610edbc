#include "cells/packed_numbers.h"

#include <fmt/format.h>

#include <algorithm>

#include "cells/leaf_faces.h"

namespace occlod::vlod {

std::vector<std::uint32_t> differences_of(std::span<const SplitId> numbers) {
  std::vector<std::uint32_t> differences;
  differences.reserve(numbers.size());
  std::uint32_t next = 0;
  for (const SplitId number : numbers) {
    differences.push_back(number - next);
    next = number + 1;
  }
  return differences;
}

PackedNumbers::PackedNumbers(sections::SectionReader& reader, const PackedGeometry& geometry,
                             std::span<const VlodObject> objects) {
  const std::span<const std::uint32_t> differences = reader.read<std::uint32_t>(permutation_name);
  std::uint64_t count = 0;
  for (const MeshRow& mesh : geometry.meshes()) count += mesh.splits;
  if (differences.size() != count)
    reader.refuse("section PERM", fmt::format("has {} splits, the meshes have {}", differences.size(), count));
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    if (geometry.mesh_of(i) != numbers_.size()) continue;  // not the first object of its mesh
    const std::size_t splits = geometry.mesh(geometry.mesh_of(i)).splits;
    if (!take(differences.subspan(at, splits), objects[i].split_count))
      reader.refuse("section PERM", fmt::format("does not number the splits of object {}", i));
    at += splits;
  }
}

bool PackedNumbers::take(std::span<const std::uint32_t> differences, std::uint32_t end) {
  std::vector<bool> taken(end, false);
  std::vector<SplitId>& numbers = numbers_.emplace_back();
  numbers.reserve(differences.size());
  std::uint32_t next = 0;
  for (const std::uint32_t difference : differences) {
    numbers.push_back(next + difference);
    next = numbers.back() + 1;
    if (numbers.back() >= end || taken[numbers.back()]) return false;
    taken[numbers.back()] = true;
  }
  return true;
}

void PackedNumbers::restore(std::uint32_t mesh, ObjectAdditions& additions) const {
  const std::vector<SplitId>& numbers = numbers_[mesh];
  for (SplitId& split : additions.splits) split = numbers[split];
  for (FaceRef& face : additions.hidden)
    if (face.split != no_id) face.split = numbers[face.split];
  std::ranges::sort(additions.splits);
  std::ranges::sort(additions.hidden, {}, face_key);
}

}  // namespace occlod::vlod
