#include "refine/node_visits.h"

#include <algorithm>

#include "base/platform.h"
#include "refine/weigh_splits.h"
#include "refine/forest.h"

namespace occlod {

void NodeVisits::begin(const RefinedScene& scene, const EntryQueries& entries, std::span<const Entry> visits) {
  constexpr std::size_t piece_size = 64;
  scene_ = scene;
  entries_ = &entries;
  piece_count_ = (visits.size() + piece_size - 1) / piece_size;
  if (pieces_.size() < piece_count_) pieces_.resize(piece_count_);
  for (std::size_t i = 0; i < piece_count_; ++i) {
    const std::span<const Entry> part =
        visits.subspan(i * piece_size, std::min(piece_size, visits.size() - i * piece_size));
    pieces_[i].visits.assign(part.begin(), part.end());
  }
  next_ = 0;
}

void NodeVisits::work(std::size_t thread) {
  for (std::size_t i = next_.fetch_add(1); i < piece_count_; i = next_.fetch_add(1)) {
    Piece& piece = pieces_[i];
    piece.by_caller = thread == 0;
    entries_->take_out_hidden(piece.visits, piece.questions);
    evaluate(piece, scratch_[thread]);
  }
}

void NodeVisits::evaluate(Piece& piece, Scratch& scratch) const {
  const std::span<const Entry> visits = piece.visits;
  piece.found.resize(visits.size());
  for (std::size_t first = 0, end = 0; first < visits.size(); first = end) {
    while (end < visits.size() && visits[end].object == visits[first].object) ++end;
    evaluate_object(visits.subspan(first, end - first), std::span(piece.found).subspan(first, end - first), scratch);
  }
}

// In steps, so that what one of them wants from memory is on its way while others are at work.
void NodeVisits::evaluate_object(std::span<const Entry> visits, std::span<Found> found, Scratch& scratch) const {
  auto& [star_visibility, splits, children, stars, scales_px] = scratch;
  const std::uint32_t object = visits.front().object;
  const Hierarchy& hierarchy = scene_.hierarchy(object);
  const ObjectView& view = scene_.views[object];
  const RefineOptions* const options = scene_.options;
  const bool wants_stars = options->priority.culling == Culling::star;
  const bool attributes = scene_.objects[object].attributes;
  splits.clear();
  children.clear();
  for (const Entry& visit : visits) prefetch(&hierarchy.node(visit.split));
  for (const Entry& visit : visits) {
    const SplitNode& node = hierarchy.node(visit.split);
    if (wants_stars) prefetch(hierarchy.data().stars.data() + node.star);
    splits.push_back(visit.split);
    for (const SplitId child : {node.child_u, node.child_v}) {
      children.push_back(child);
      if (child != no_id) prefetch(&hierarchy.node(child));
    }
  }
  if (wants_stars) {
    for (const SplitId s : splits)
      if (const SplitStar star = hierarchy.star(s); star.is_fan())
        for (const VertexId v : star.ring()) prefetch(&hierarchy.positions()[v]);
    stars.resize(splits.size());
    star_visibility.evaluate(hierarchy, splits, view, scene_.objects[object].two_sided, stars);
    for (std::size_t i = 0; i < found.size(); ++i) {
      found[i].value = scene_.importances[object].of(stars[i], errors_of(hierarchy, splits[i], attributes));
    }
  }
  scales_px.resize(children.size());
  weigh_splits(hierarchy, children, view, scene_.gate->tests_cone(object), scales_px);
  for (std::size_t i = 0; i < children.size(); ++i) {
    Child& child = found[i / 2].children[i % 2];
    child = {children[i], scales_px[i], {}};
    if (child.split == no_id) continue;
    require_parent(hierarchy, child.split, splits[i / 2]);
    child.error = ScreenError(errors_of(hierarchy, child.split, attributes), child.scale_px);
  }
}

}  // namespace occlod
