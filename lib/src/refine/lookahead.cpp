#include "refine/lookahead.h"

#include <algorithm>

#include "core/platform.h"
#include "priority/weigh_splits.h"

namespace occlod {

// In steps, so that what one of them wants from memory is on its way while the one before is at work.
void Lookahead::weigh_children(Entry& entry, Queue& queue) {
  gather(entry, queue);
  for (std::size_t i = 0; i < size_; ++i) {
    const SplitNode& node = scene_.hierarchy(entry.object).node(entries_[i]->split);
    splits_[2 * i] = node.child_u;
    splits_[2 * i + 1] = node.child_v;
    prefetch_star(*entries_[i]);
  }
  std::array<float, batch_size> scales;
  weigh(entry.object, std::span(splits_.data(), 2 * size_), scales);
  for (std::size_t i = 0; i < size_; ++i) {
    entries_[i]->children_weighed = true;
    entries_[i]->child_scales_px = {scales[2 * i], scales[2 * i + 1]};
    if (looks_at_stars_)
      prefetch_corners(*entries_[i]);
    else
      (*scene_.cuts)[entry.object].prefetch_needs(entries_[i]->split);
  }
}

// This entry, and the next ones of the queue whose children are wanted.
void Lookahead::gather(Entry& entry, Queue& queue) {
  const Hierarchy& hierarchy = scene_.hierarchy(entry.object);
  entries_[0] = &entry;
  size_ = 1;
  std::size_t entries_left = most_entries;
  queue.for_top([&](Entry& next) {
    if (next.kind == Entry::Kind::apply) {
      prefetch_star(next);
    } else if (!next.children_weighed && next.object == entry.object) {
      prefetch(&hierarchy.node(next.split));
      entries_[size_++] = &next;
    }
    return --entries_left > 0 && size_ < entries_.size();
  });
}

void Lookahead::prefetch_star(const Entry& entry) const {
  const Hierarchy& hierarchy = scene_.hierarchy(entry.object);
  prefetch(hierarchy.data().stars.data() + hierarchy.node(entry.split).star);
}

// Of the star.
void Lookahead::prefetch_corners(const Entry& entry) const {
  const Hierarchy& hierarchy = scene_.hierarchy(entry.object);
  const SplitStar star = hierarchy.star(entry.split);
  if (!star.is_fan()) return;
  for (const VertexId v : star.ring()) prefetch(&hierarchy.positions()[v]);
}

void Lookahead::weigh(std::uint32_t object, std::span<const SplitId> splits, std::span<float> scales_px) {
  const Hierarchy& hierarchy = scene_.hierarchy(object);
  std::array<float, batch_size> scales;
  for (std::size_t first = 0; first < splits.size(); first += batch_size) {
    const std::span<const SplitId> batch = splits.subspan(first, std::min(batch_size, splits.size() - first));
    for (const SplitId s : batch) {
      hierarchy.require(s);
      if (s != no_id) prefetch(&hierarchy.node(s));
    }
    for (std::size_t i = 0; i < batch.size(); ++i)
      if (batch[i] != no_id) nodes_[i] = hierarchy.node(batch[i]);
    // Whole vectors: what earlier batches have left in the last one does no harm.
    const std::size_t weighed = (batch.size() + lanes - 1) / lanes * lanes;
    weigh_splits(std::span(nodes_.data(), weighed), scene_.views[object], scene_.gate->tests_cone(object), scales);
    std::copy_n(scales.begin(), batch.size(), scales_px.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

}  // namespace occlod
