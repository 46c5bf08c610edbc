#include "cells/packed_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "cells/leaf_faces.h"
#include "cells/vlod_format.h"
#include "occlod/base.h"

namespace occlod {
namespace {

using Ids = std::vector<std::uint32_t>;

// Stores the nodes that add each id, in depth-first order.
class Adders {
 public:
  Adders(std::span<const Ids> added, std::uint32_t count) : first_(count + std::size_t{1}, 0) {
    for (const Ids& ids : added)
      for (const std::uint32_t id : ids) ++first_[id + std::size_t{1}];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    nodes_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t n = 0; n < added.size(); ++n)
      for (const std::uint32_t id : added[n]) nodes_[next[id]++] = static_cast<std::uint32_t>(n);
  }

  // Returns a sort key from the first two nodes; lists that end sort last.
  [[nodiscard]] std::uint64_t key(std::uint32_t id) const {
    const auto list = of(id);
    return std::uint64_t{list.empty() ? no_id : list[0]} << 32U | (list.size() < 2 ? no_id : list[1]);
  }
  [[nodiscard]] bool less(std::uint32_t a, std::uint32_t b) const {
    const auto left = of(a), right = of(b);
    const auto [l, r] = std::mismatch(left.begin(), left.end(), right.begin(), right.end());
    if (l != left.end() && r != right.end()) return *l < *r;
    if (l == left.end() && r == right.end()) return a < b;
    return r == right.end();
  }

 private:
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t id) const {
    return {nodes_.data() + first_[id], first_[id + std::size_t{1}] - first_[id]};
  }

  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> nodes_;
};

using Keyed = std::pair<std::uint64_t, std::uint32_t>;

std::vector<std::uint32_t> places_of(const std::vector<Keyed>& order) {
  std::vector<std::uint32_t> places(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) places[order[i].second] = i;
  return places;
}

}  // namespace

std::vector<std::uint32_t> places_by_nodes(std::span<const Ids> added, std::uint32_t count) {
  const Adders adders(added, count);
  std::vector<Keyed> order(count);
  for (std::uint32_t id = 0; id < count; ++id) order[id] = {adders.key(id), id};
  std::sort(order.begin(), order.end(), [&](const Keyed& a, const Keyed& b) {
    return a.first != b.first ? a.first < b.first : adders.less(a.second, b.second);
  });
  return places_of(order);
}

}  // namespace occlod

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
                             std::span<const StoredObject> objects) {
  const std::span<const std::uint32_t> differences = reader.read<std::uint32_t>(permutation_name);
  std::uint64_t count = 0;
  for (const MeshRow& mesh : geometry.meshes()) count += mesh.splits;
  if (differences.size() != count)
    reader.refuse("section PERM", fmt::format("has {} splits, the meshes have {}", differences.size(), count));
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    if (geometry.mesh_of(i) != numbers_.size()) continue;  // skip all but the first object of each mesh
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
