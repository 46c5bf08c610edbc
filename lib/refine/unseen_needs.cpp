#include "refine/unseen_needs.h"

#include <algorithm>
#include <cmath>

namespace occlod {
namespace {

// Of what needs what: no file can use up the stack.
constexpr int most_depth = 64;
// In frames, for which what a split needs is held to be known.
constexpr std::uint16_t most_age = 4;
// In splits: more than this counts as this, so that what is kept by others anyway sinks to a third at most.
constexpr float most_kept = 2.0F;

std::uint32_t count_removed(const SplitStar& star, SplitId from) {
  std::uint32_t faces = 0;
  star.for_each_removed_ref([&](const FaceRef& face) { faces += face.split == from ? 1U : 0U; });
  return faces;
}

}  // namespace

float UnseenNeeds::weight_of_applied(std::uint32_t object, SplitId s) {
  return weight(std::min(needed_by(object, s, most_depth), most_kept));
}

float UnseenNeeds::weight_of_closure(std::uint32_t object, const Cut::Closure& closure) {
  float kept = 0.0F, forced = 0.0F;
  for (const SplitId s : closure.splits) {
    kept += needed_by_unapplied(object, s);
    if (s != closure.splits[0]) forced += unseen_part(object, s);
  }
  return weight(std::min(kept, most_kept) + forced);
}

// What removes several faces of one is charged for each.
float UnseenNeeds::needed_by(std::uint32_t object, SplitId s, int depth) {
  const Cut& cut = (*evaluation_.scene().cuts)[object];
  const SplitStar star = evaluation_.scene().hierarchy(object).star(s);
  float unseen = 0.0F;
  star.for_each_removed_ref([&](const FaceRef& face) {
    if (face.split == no_id) return;
    unseen += charge(object, face.split, count_removed(star, face.split), cut.removed_faces(face.split), depth);
  });
  return unseen;
}

// Of what is applied already.
float UnseenNeeds::needed_by_unapplied(std::uint32_t object, SplitId s) {
  const Cut& cut = (*evaluation_.scene().cuts)[object];
  const SplitStar star = evaluation_.scene().hierarchy(object).star(s);
  float unseen = 0.0F;
  star.for_each_removed_ref([&](const FaceRef& face) {
    if (face.split == no_id || !cut.applied(face.split)) return;
    const std::uint32_t own = count_removed(star, face.split);
    unseen += charge(object, face.split, own, own + cut.removed_faces(face.split), most_depth);
  });
  return unseen;
}

// For each of `own` faces among those removed.
float UnseenNeeds::charge(std::uint32_t object, SplitId s, std::uint32_t own, std::uint32_t removed, int depth) {
  const float part = unseen_part(object, s);
  if (part == 0.0F) return 0.0F;
  const float whole = 1.0F + below(object, evaluation_.front(object).find(s), depth);
  return part * whole / std::sqrt(static_cast<float>(own) * static_cast<float>(removed));
}

// What an applied split needs.
float UnseenNeeds::below(std::uint32_t object, Front::Index k, int depth) {
  Front& front = evaluation_.front(object);
  const auto now = static_cast<std::uint16_t>(frame_);
  const auto age = static_cast<std::uint16_t>(now - front.node(k).weighed_frame);
  if (front.is(k, Front::needs_known) && age < most_age) return front.node(k).unseen_needs;
  if (depth == 0) return 0.0F;
  const float found = needed_by(object, front.node(k).split, depth - 1);
  FrontNode& node = front.node(k);
  node.unseen_needs = found;
  node.weighed_frame = now;
  front.set(k, Front::needs_known, true);
  return found;
}

float UnseenNeeds::unseen_part(std::uint32_t object, SplitId s) {
  Front& front = evaluation_.front(object);
  const Front::Index k = front.find(s);
  if (k == Front::none) return 1.0F - evaluation_.scene().importances[object].visible_share(s);
  if (front.is(k, Front::hidden)) return 1.0F;
  if (front.priorities().is_outdated(k)) static_cast<void>(evaluation_.worth(object, k));
  return 1.0F - front.visible_share(k);
}

float UnseenNeeds::weight(float unseen) const {
  const RefineOptions* const options = evaluation_.scene().options;
  const double exponent = options->priority.forced_exponent;
  return exponent == 1.0 ? 1.0F / (1.0F + unseen) : std::pow(1.0F + unseen, -static_cast<float>(exponent));
}

}  // namespace occlod
