#include "traverse/front_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace occlod::hlod::test {
namespace {

bool has_drawn_patch(const Hlod& hlod, const std::vector<int>& drawn, NodeId n) {
  const auto first = drawn.begin() + static_cast<std::ptrdiff_t>(hlod.node(n).first_patch);
  return std::any_of(first, first + hlod.node(n).patches, [](int count) { return count > 0; });
}

// Parents of what is drawn are refined; so is the only parent of what is refined. Of several one may have been culled.
Refined surely_refined(const Hlod& hlod, const std::vector<int>& drawn) {
  Refined refined(hlod.node_count(), 0);
  for (NodeId n = static_cast<NodeId>(hlod.node_count()); n-- > 0;) {  // children first
    std::size_t place = hlod.node(n).first_patch;
    for (const Patch& patch : hlod.patches(n)) {
      const bool is_only = hlod.node(n).patches == 1;
      if (patch.parent != no_id && (drawn[place] > 0 || (refined[n] != 0 && is_only))) refined[patch.parent] = 1;
      ++place;
    }
  }
  return refined;
}

}  // namespace

std::vector<int> drawn_patches(const Hlod& hlod, const Frame& frame) {
  std::vector<int> drawn(hlod.data().patches.size(), 0);
  for (const DrawnNode& node : frame.draws)
    for (std::uint32_t r = 0; r < node.range_count; ++r) {
      const DrawRange& range = frame.ranges[node.first_range + r];
      std::size_t place = hlod.node(node.node).first_patch;
      for (const Patch& patch : hlod.patches(node.node)) {
        if (range.first_index <= patch.first_index && patch.first_index < range.first_index + range.index_count)
          ++drawn[place];
        ++place;
      }
    }
  return drawn;
}

std::size_t illegal_nodes(const Hlod& hlod, const Frame& frame) {
  const std::vector<int> drawn = drawn_patches(hlod, frame);
  const Refined refined = surely_refined(hlod, drawn);
  std::set<NodeId> illegal;
  std::size_t patches = 0, nodes = 0;
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    nodes += has_drawn_patch(hlod, drawn, n) ? 1U : 0U;
    if (refined[n] == 0) continue;
    if (has_drawn_patch(hlod, drawn, n)) illegal.insert(n);
    for (const Patch& patch : hlod.patches(n))
      if (patch.parent != no_id && has_drawn_patch(hlod, drawn, patch.parent)) illegal.insert(patch.parent);
  }
  for (const int count : drawn) {
    EXPECT_LE(count, 1);
    patches += static_cast<std::size_t>(count);
  }
  EXPECT_EQ(patches, frame.stats.drawn_patches);
  EXPECT_EQ(nodes, frame.stats.drawn_nodes);
  return illegal.size();
}

std::vector<int> patches_of(const Hlod& hlod, const Refined& refined) {
  std::vector<int> drawn(hlod.data().patches.size(), 0);
  for_each_drawn(hlod, refined, [&](NodeId, const Patch&, std::size_t place) { drawn[place] = 1; });
  return drawn;
}

Refined min_front(const Hlod& hlod, const std::vector<int>& drawn) {
  Refined refined(hlod.node_count(), 0);
  for (NodeId n = static_cast<NodeId>(hlod.node_count()); n-- > 0;) {  // children first
    std::size_t place = hlod.node(n).first_patch;
    for (const Patch& patch : hlod.patches(n)) {
      if (patch.parent != no_id && (drawn[place] > 0 || refined[n] != 0)) refined[patch.parent] = 1;
      ++place;
    }
  }
  return refined;
}

std::size_t clear_refined(const Hlod& hlod, const Refined& refined, std::vector<int>& drawn) {
  std::size_t nodes = 0;
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    if (refined[n] == 0 || !has_drawn_patch(hlod, drawn, n)) continue;
    ++nodes;
    std::fill_n(drawn.begin() + static_cast<std::ptrdiff_t>(hlod.node(n).first_patch), hlod.node(n).patches, 0);
  }
  return nodes;
}

}  // namespace occlod::hlod::test
