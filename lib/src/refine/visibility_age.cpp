#include <algorithm>

#include "occlod/refine/refiner.h"
#include "refine/frames.h"

namespace occlod {

// Nodes keep the low bits of the numbers of the occluders before which they were shown: ages are right up to 65,535
// occluders, and begin at 0 again beyond them. Bounds of a subtree hold those of all below: what shows a split shows
// those that it descends from, and ids rise along the forest.
std::vector<std::uint32_t> Frames::visibility_ages(std::uint32_t object, std::span<const SplitId> splits) const {
  const std::uint32_t since_adopted = draw_ - adopted_draw_;
  std::vector<std::uint32_t> ages(splits.size(), since_adopted == 0 ? 0 : never_asked);
  const auto since = [&](std::uint16_t shown) -> std::uint32_t { return static_cast<std::uint16_t>(draw_ - shown); };
  const Hierarchy& hierarchy = refined_.cuts[object].hierarchy();
  for (std::size_t i = splits.size(); i-- > 0;) {
    const Front& front = objects_[object].front;
    if (const Front::Index k = front.find(splits[i]); k != Front::none) {
      const std::uint32_t age = std::min(since(front.node(k).subtree_shown), since(front.node(k).star_shown));
      if (age < since_adopted) ages[i] = std::min(ages[i], age);
    }
    const auto parent = std::lower_bound(splits.begin(), splits.end(), hierarchy.node(splits[i]).parent);
    if (parent == splits.end() || *parent != hierarchy.node(splits[i]).parent) continue;
    std::uint32_t& age = ages[static_cast<std::size_t>(parent - splits.begin())];
    age = std::min(age, ages[i]);
  }
  return ages;
}

}  // namespace occlod
