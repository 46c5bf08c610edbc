#include "cells/packed_tree.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "cells/vlod_payload.h"

namespace occlod {

using vlod::Additions;
using vlod::Expected;
using vlod::most_ids_per_byte;

PackedTree pack(CellSubtree tree) {
  CellSets sets = std::exchange(tree.sets, {});
  const SetCounts counts{sets.splits.size(), sets.candidates.size(), sets.hidden.size(), sets.used.size(),
                         sets.drawn.size()};
  const Additions shared{std::move(sets.splits), std::move(sets.candidates), std::move(sets.hidden)};
  const Additions used{std::move(sets.used), {}, std::move(sets.drawn)};
  return {std::move(tree), {encode(shared, {}, most_ids_per_byte), encode(used, {}, most_ids_per_byte), counts}};
}

std::optional<CellSets> unpack(std::span<const std::byte> shared, std::span<const std::byte> used,
                               const SetCounts& counts, const vlod::GlobalIds& ids, std::string& problem) {
  const auto decoded = [&](std::span<const std::byte> bytes, std::uint64_t splits, std::uint64_t candidates,
                           std::uint64_t faces) -> std::optional<Additions> {
    problem = "claims more than it can hold";
    if (std::max({splits, candidates, faces}) > bytes.size() * most_ids_per_byte) return {};
    return decode(bytes, Expected{ids.split_count(), ids.owner_count(), splits, candidates, faces}, {}, problem);
  };
  auto first = decoded(shared, counts.splits, counts.candidates, counts.hidden);
  if (!first) return {};
  auto second = decoded(used, counts.used, 0, counts.drawn);
  if (!second) return {};
  return CellSets{std::move(first->splits), std::move(second->splits), std::move(first->candidates),
                  std::move(first->hidden), std::move(second->hidden)};
}

CellSubtree unpack(PackedTree packed, const vlod::GlobalIds& ids) {
  std::string problem;
  auto sets = unpack(packed.sets.shared, packed.sets.used, packed.sets.counts, ids, problem);
  assert(sets.has_value());  // what pack() has made
  packed.tree.sets = std::move(*sets);
  return std::move(packed.tree);
}

}  // namespace occlod
