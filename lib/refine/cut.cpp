#include "refine/cut.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <glm/common.hpp>
#include <numeric>
#include <string>

#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/refiner.h"
#include "splits/star.h"

namespace occlod {
namespace {

std::uint64_t key_of(SplitId s, std::uint32_t slot) { return std::uint64_t{s} << 32U | slot; }

std::ptrdiff_t gain_of(const SplitStar& star) {
  return static_cast<std::ptrdiff_t>(star.inserted_count()) - static_cast<std::ptrdiff_t>(star.removed_count());
}

// Sorts ids in ascending order by their digits. `scratch` becomes as large as `ids`.
void sort_ids(std::vector<SplitId>& ids, std::vector<SplitId>& scratch) {
  constexpr unsigned digit_bits = 11;
  constexpr std::size_t digits = std::size_t{1} << digit_bits;
  if (std::is_sorted(ids.begin(), ids.end())) return;
  const unsigned bits = static_cast<unsigned>(std::bit_width(*std::max_element(ids.begin(), ids.end())));
  scratch.resize(ids.size());
  for (unsigned shift = 0; shift < bits; shift += digit_bits) {
    std::array<std::uint32_t, digits> end{};
    for (const SplitId s : ids) ++end[s >> shift & (digits - 1)];
    std::exclusive_scan(end.begin(), end.end(), end.begin(), 0U);
    for (const SplitId s : ids) scratch[end[s >> shift & (digits - 1)]++] = s;
    ids.swap(scratch);
  }
}

// Throws Error for damage that checking the splits of a file one by one does not find.
[[noreturn]] void fail_removed_twice(SplitId s) {
  throw Error(
      {"hierarchy", "split " + std::to_string(s), "removes a face that is not there any more", "build it again"});
}

}  // namespace

Cut::Cut(const Hierarchy& hierarchy)
    : hierarchy_(&hierarchy),
      state_(zeroed_array<std::uint32_t>(hierarchy.split_count())),
      base_removed_(hierarchy.base_triangle_count(), false),
      triangles_(hierarchy.base_triangle_count()) {}

void Cut::clear() {
  for (const SplitId s : applied_) state_[s] = 0;
  base_removed_.assign(base_removed_.size(), false);
  others_removed_.clear();
  corner_needs_.clear();
  applied_.clear();
  some_taken_back_ = false;
  triangles_ = hierarchy_->base_triangle_count();
}

Cut::Closure Cut::closure(SplitId s) {
  assert(!applied(s));
  closure_.resize(1);
  closure_[0] = s;
  hierarchy_->require(s);
  if (const SplitStar star = star_of(*hierarchy_, s); needs_no_other(star)) {
    closure_gain_ = gain_of(star);
    return {closure_, static_cast<std::size_t>(std::max<std::ptrdiff_t>(closure_gain_, 0))};
  }
  state_[s] |= closure_bit;
  closure_gain_ = 0;
  // closure_ is both the result and the queue of what is still to be looked at.
  for (std::size_t i = 0; i < closure_.size(); ++i) {
    if (i + 1 < closure_.size()) prefetch(hierarchy_->data().stars.data() + hierarchy_->node(closure_[i + 1]).star);
    hierarchy_->require(closure_[i]);
    const SplitStar star = star_of(*hierarchy_, closure_[i]);
    closure_gain_ += gain_of(star);
    for (const SplitId needed : star.dependencies())
      if ((state_[needed] & (applied_bit | closure_bit)) == 0) {
        state_[needed] |= closure_bit;
        prefetch(&hierarchy_->node(needed));
        closure_.push_back(needed);
      }
  }
  for (const SplitId t : closure_) state_[t] &= ~closure_bit;
  return {closure_, static_cast<std::size_t>(std::max<std::ptrdiff_t>(closure_gain_, 0))};
}

bool Cut::needs_no_other(const SplitStar& star) const {
  std::uint32_t state = applied_bit;
  for (const SplitId needed : star.dependencies()) state &= state_[needed];
  return state != 0;
}

void Cut::apply_closure() {
  for (const SplitId s : closure_) apply(s);
  triangles_ = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(triangles_) + closure_gain_);
  closure_.clear();
  closure_gain_ = 0;
}

void Cut::apply(SplitId s) {
  const SplitStar star = star_of(*hierarchy_, s);
  star.for_each_removed_ref([&](const FaceRef& face) {
    if (removed(face)) fail_removed_twice(s);
    if (face.split != no_id && face.slot < mask_slots)
      state_[face.split] |= 1U << face.slot;
    else
      set_removed(face, true);
  });
  for_each_corner_need(star, [&](SplitId needed) { ++corner_needs_[needed]; });
  if ((state_[s] & listed_bit) == 0) applied_.push_back(s);
  state_[s] |= applied_bit | listed_bit;
}

bool Cut::is_leaf(SplitId s) const {
  assert(applied(s));
  if ((state_[s] & mask_bits) != 0 || corner_needs_.contains(s)) return false;
  for (std::uint32_t slot = mask_slots; slot < star_of(*hierarchy_, s).inserted_count(); ++slot)
    if (removed(s, slot)) return false;
  return true;
}

std::uint32_t Cut::removed_faces(SplitId s) const {
  auto faces = static_cast<std::uint32_t>(std::popcount(state_[s] & mask_bits));
  if (others_removed_.empty()) return faces;
  for (std::uint32_t slot = mask_slots; slot < star_of(*hierarchy_, s).inserted_count(); ++slot)
    if (removed(s, slot)) ++faces;
  return faces;
}

void Cut::take_back(SplitId s) {
  assert(applied(s) && is_leaf(s));
  const SplitStar star = star_of(*hierarchy_, s);
  star.for_each_removed_ref([&](const FaceRef& face) { set_removed(face, false); });
  for_each_corner_need(star, [&](SplitId needed) {
    const auto at = corner_needs_.find(needed);
    if (--at->second == 0) corner_needs_.erase(at);
  });
  state_[s] &= ~applied_bit;
  triangles_ = triangles_ + star.removed_count() - star.inserted_count();
  some_taken_back_ = true;
}

// A split is needed only by larger ones, which have been taken back, if at all, when its turn comes.
void Cut::set(std::span<const SplitId> splits) try {
  sort_applied();
  auto kept = splits.rbegin();
  for (std::size_t i = applied_.size(); i-- > 0;) {
    const SplitId s = applied_[i];
    while (kept != splits.rend() && *kept > s) ++kept;
    if ((kept == splits.rend() || *kept != s) && is_leaf(s)) take_back(s);
  }
  drop_taken_back();
  for (const SplitId s : splits) {
    if (applied(s)) continue;
    static_cast<void>(closure(s));
    apply_closure();
  }
  sort_applied();
} catch (const Error&) {
  clear();
  throw;
}

void Cut::sort_applied() {
  drop_taken_back();
  sort_ids(applied_, sorting_);
}

void Cut::drop_taken_back() {
  if (!some_taken_back_) return;
  const auto taken_back = [&](SplitId s) { return !applied(s); };
  for (const SplitId s : applied_)
    if (taken_back(s)) state_[s] &= ~listed_bit;
  applied_.erase(std::remove_if(applied_.begin(), applied_.end(), taken_back), applied_.end());
  some_taken_back_ = false;
}

// Only ears of a boundary and stars that are not a fan have corner needs.
template <typename Visit>
void Cut::for_each_corner_need(const SplitStar& star, const Visit& visit) {
  if (star.is_fan() && star.inserted_count() == star.ring().size()) return;
  removed_from_.clear();
  star.for_each_removed_ref([&](const FaceRef& face) { removed_from_.push_back(face.split); });
  for (const SplitId needed : star.dependencies())
    if (std::find(removed_from_.begin(), removed_from_.end(), needed) == removed_from_.end()) visit(needed);
}

void Cut::set_removed(const FaceRef& face, bool removed) {
  if (face.split == no_id)
    base_removed_[face.slot] = removed;
  else if (face.slot < mask_slots)
    state_[face.split] = removed ? state_[face.split] | 1U << face.slot : state_[face.split] & ~(1U << face.slot);
  else if (removed)
    others_removed_.insert(key_of(face.split, face.slot));
  else
    others_removed_.erase(key_of(face.split, face.slot));
}

bool Cut::removed(const FaceRef& face) const {
  return face.split == no_id ? base_removed_[face.slot] : removed(face.split, face.slot);
}

bool Cut::removed(SplitId s, std::uint32_t slot) const {
  return slot < mask_slots ? (state_[s] >> slot & 1U) != 0 : others_removed_.contains(key_of(s, slot));
}

void Cut::active_triangles(std::vector<Triangle>& out, bool sorted) {
  if (sorted)
    sort_applied();
  else
    drop_taken_back();
  out.resize(triangles_);
  Triangle* at = out.data();
  for_each_active([&](const FaceRef&, const Triangle& triangle) { *at++ = triangle; });
  assert(at == out.data() + triangles_);
}

void Cut::active_wedge_triangles(std::vector<Triangle>& out, bool sorted) {
  if (!hierarchy_->has_seams()) return active_triangles(out, sorted);
  if (sorted)
    sort_applied();
  else
    drop_taken_back();
  out.resize(triangles_);
  Triangle* at = out.data();
  for_each_active([&](const FaceRef& face, const Triangle& t) { *at++ = wedges_of_face(*hierarchy_, face, t); });
  assert(at == out.data() + triangles_);
}

MorphedPositions::MorphedPositions(std::span<const glm::vec3> positions)
    : own_(positions), drawn_(positions.begin(), positions.end()) {}

void MorphedPositions::update(std::span<const Geomorph> geomorphs) {
  for (const VertexId v : under_way_) drawn_[v] = own_[v];
  moved_.swap(under_way_);
  under_way_.clear();
  for (const Geomorph& g : geomorphs) {
    drawn_[g.vertex] = glm::mix(drawn_[g.parent], own_[g.vertex], g.t);
    under_way_.push_back(g.vertex);
  }
  moved_.insert(moved_.end(), under_way_.begin(), under_way_.end());
  std::sort(moved_.begin(), moved_.end());
  moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
}

}  // namespace occlod
