#include "cells/cell_subtree.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "mesh/section_file.h"
#include "occlod/core/error.h"
#include "cells/cell_geometry.h"
#include "cells/vlod_format.h"
#include "cells/vlod_payload.h"

namespace occlod {
namespace {

using Set = std::vector<std::uint64_t>;

template <typename Operation>
Set combined(const Set& a, const Set& b, const Operation& operation) {
  Set result;
  operation(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}
constexpr auto in_both = [](auto... args) { std::set_intersection(args...); };
constexpr auto in_either = [](auto... args) { std::set_union(args...); };
constexpr auto not_in = [](auto... args) { std::set_difference(args...); };

// Of one tree of all parts.
CellSets joined_sets(std::span<const CellSubtree> parts) {
  CellSets sets = parts.front().sets;
  sets.candidates.clear();
  for (const CellSubtree& part : parts.subspan(1)) {
    sets.splits = combined(sets.splits, part.sets.splits, in_both);
    sets.candidates = combined(sets.candidates, combined(sets.used, part.sets.used, in_both), in_either);
    sets.used = combined(sets.used, part.sets.used, in_either);
    sets.hidden = combined(sets.hidden, part.sets.hidden, in_either);
    sets.drawn = combined(sets.drawn, part.sets.drawn, in_either);
  }
  sets.candidates = combined(sets.candidates, sets.splits, not_in);
  sets.hidden = combined(sets.hidden, sets.drawn, not_in);
  return sets;
}

// What the root of a tree adds to what is above it becomes its payload, behind all others.
void add_payload(CellSubtree& tree, const CellSets& above) {
  const vlod::Additions additions{combined(tree.sets.splits, above.splits, not_in), std::move(tree.sets.candidates),
                                  combined(tree.sets.hidden, above.hidden, not_in)};
  const std::vector<std::byte> bytes = vlod::encode(additions, above.candidates, vlod::most_ids_per_byte);
  CellNode& root = tree.nodes.front();
  if (bytes.size() > vlod::most_payload_bytes)
    throw Error({"cells", "", "one of them adds more than 16 MiB", "allow a larger tolerance"});
  root.payload = tree.payloads.size();
  root.payload_bytes = static_cast<std::uint32_t>(bytes.size());
  root.checksum = sections::checksum_of(bytes);
  root.splits = static_cast<std::uint32_t>(additions.splits.size());
  root.candidates = static_cast<std::uint32_t>(additions.candidates.size());
  root.hidden_faces = static_cast<std::uint32_t>(additions.hidden.size());
  tree.payloads.insert(tree.payloads.end(), bytes.begin(), bytes.end());
}

// `part` becomes a child of the first node of `tree`.
void append(CellSubtree& tree, CellSubtree part) {
  const auto first = static_cast<CellId>(tree.nodes.size());
  for (CellNode& node : part.nodes) {
    node.parent = node.parent == no_id ? 0 : node.parent + first;
    node.end += first;
    node.payload += tree.payloads.size();
    tree.nodes.push_back(node);
  }
  tree.payloads.insert(tree.payloads.end(), part.payloads.begin(), part.payloads.end());
  tree.nodes.front().box = unite(tree.nodes.front().box, part.nodes.front().box);
  tree.nodes.front().end = static_cast<CellId>(tree.nodes.size());
}

}  // namespace

CellSubtree leaf_of_tree(const CellNode& node, CellSets sets) {
  CellSubtree tree{{node}, {}, std::move(sets)};
  tree.nodes.front().parent = no_id;
  tree.nodes.front().end = 1;
  tree.sets.used = tree.sets.splits;
  return tree;
}

CellSubtree join(std::vector<CellSubtree> parts) {
  CellSubtree tree{{CellNode{}}, {}, joined_sets(parts)};
  tree.nodes.front().box = parts.front().nodes.front().box;
  for (CellSubtree& part : parts) {
    add_payload(part, tree.sets);
    append(tree, std::exchange(part, {}));
  }
  return tree;
}

void set_levels(CellSubtree& tree) {
  for (CellNode& node : tree.nodes) node.level = node.parent == no_id ? 0 : tree.nodes[node.parent].level + 1;
}

void finish(CellSubtree& tree) {
  add_payload(tree, {});
  set_levels(tree);
  // In the order of the nodes, whatever order the tree has grown in.
  std::vector<std::byte> payloads;
  payloads.reserve(tree.payloads.size());
  for (CellNode& node : tree.nodes) {
    const auto bytes = std::span(tree.payloads).subspan(node.payload, node.payload_bytes);
    node.payload = payloads.size();
    payloads.insert(payloads.end(), bytes.begin(), bytes.end());
  }
  tree.payloads = std::move(payloads);
}

}  // namespace occlod
