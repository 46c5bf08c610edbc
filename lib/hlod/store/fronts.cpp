#include "hlod/store/fronts.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "hlod/build/whole_splits.h"

namespace occlod::hlod {
namespace {

// In [0, 1), the same with every standard library.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11U) * 0x1p-53; }

bool are_parents_refined(const Hlod& hlod, const Refined& refined, NodeId n) {
  return std::ranges::all_of(hlod.patches(n),
                             [&](const Patch& patch) { return patch.parent == no_id || refined[patch.parent] != 0; });
}

}  // namespace

Refined random_front(const Hlod& hlod, std::mt19937_64& random) {
  const double probability = 0.3 + 0.7 * uniform(random);
  const bool is_local = random() % 2 == 0;
  const Box& box = hlod.data().box;
  const glm::dvec3 size = glm::dvec3(box.max) - glm::dvec3(box.min);
  const glm::dvec3 middle(hlod.node(static_cast<NodeId>(random() % hlod.node_count())).sphere.center);
  const double reach = glm::length(size) * 0.5 * uniform(random);
  const auto wanted = [&](const Node& node) {
    if (!is_local) return probability;
    const double distance = glm::distance(glm::dvec3(node.sphere.center), middle);
    return distance < reach + static_cast<double>(node.sphere.radius) ? 0.97 : 0.03;
  };
  Refined refined(hlod.node_count(), 0);
  for (NodeId n = 0; n < hlod.node_count(); ++n) {  // parents first
    if (hlod.node(n).level == 0) continue;
    const bool may_be = are_parents_refined(hlod, refined, n);
    refined[n] = uniform(random) < wanted(hlod.node(n)) && may_be ? 1 : 0;
  }
  return refined;
}

Cuts random_cuts_of(const Hlod& hlod, const Refined& refined, std::mt19937_64& random) {
  Cuts cuts(hlod.node_count(), 0);
  for (NodeId n = 0; n < hlod.node_count(); ++n)
    if (hlod.has_within(n) && refined[n] == 0 && are_parents_refined(hlod, refined, n) && random() % 2 == 0)
      cuts[n] = whole_splits(hlod, n, static_cast<std::uint32_t>(random() % (hlod.data().within[n].splits + 1U)));
  return cuts;
}

}  // namespace occlod::hlod
