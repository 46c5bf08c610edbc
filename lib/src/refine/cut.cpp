#include "cut.h"

#include <algorithm>
#include <cassert>
#include <new>

namespace occlod {
namespace {

std::unique_ptr<std::uint32_t[], decltype(&std::free)> zeros(std::size_t count) {
  void* const memory = std::calloc(std::max<std::size_t>(count, 1), sizeof(std::uint32_t));
  if (memory == nullptr) throw std::bad_alloc();
  return {static_cast<std::uint32_t*>(memory), &std::free};
}

std::uint64_t key_of(SplitId s, std::uint32_t slot) { return std::uint64_t{s} << 32U | slot; }

}  // namespace

Cut::Cut(const Hierarchy& hierarchy)
    : hierarchy_(&hierarchy),
      state_(zeros(hierarchy.split_count())),
      base_removed_(hierarchy.base_triangle_count(), false),
      triangles_(hierarchy.base_triangle_count()) {}

void Cut::clear() {
  for (const SplitId s : applied_) state_[s] = 0;
  base_removed_.assign(base_removed_.size(), false);
  others_removed_.clear();
  applied_.clear();
  triangles_ = hierarchy_->base_triangle_count();
}

Cut::Closure Cut::closure(SplitId s) {
  assert(!applied(s));
  closure_.assign(1, s);
  state_[s] |= closure_bit;
  closure_gain_ = 0;
  // closure_ is both the result and the queue of what is still to be looked at.
  for (std::size_t i = 0; i < closure_.size(); ++i) {
    hierarchy_->require(closure_[i]);
    const SplitStar star = hierarchy_->star(closure_[i]);
    closure_gain_ +=
        static_cast<std::ptrdiff_t>(star.inserted_count()) - static_cast<std::ptrdiff_t>(star.removed_count());
    for (const SplitId needed : star.dependencies())
      if ((state_[needed] & (applied_bit | closure_bit)) == 0) {
        state_[needed] |= closure_bit;
        closure_.push_back(needed);
      }
  }
  for (const SplitId t : closure_) state_[t] &= ~closure_bit;
  return {closure_, static_cast<std::size_t>(std::max<std::ptrdiff_t>(closure_gain_, 0))};
}

void Cut::apply_closure() {
  for (const SplitId s : closure_) {
    state_[s] |= applied_bit;
    hierarchy_->star(s).for_each_removed([&](const FaceRef& face, const Triangle&) { remove(face); });
  }
  applied_.insert(applied_.end(), closure_.begin(), closure_.end());
  triangles_ = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(triangles_) + closure_gain_);
  closure_.clear();
  closure_gain_ = 0;
}

void Cut::remove(const FaceRef& face) {
  if (face.split == no_id)
    base_removed_[face.slot] = true;
  else if (face.slot < mask_slots)
    state_[face.split] |= 1U << face.slot;
  else
    others_removed_.insert(key_of(face.split, face.slot));
}

bool Cut::removed(SplitId s, std::uint32_t slot) const {
  return slot < mask_slots ? (state_[s] >> slot & 1U) != 0 : others_removed_.contains(key_of(s, slot));
}

void Cut::active_triangles(std::vector<Triangle>& out, bool sorted) {
  out.clear();
  if (sorted) std::sort(applied_.begin(), applied_.end());
  const std::span<const Triangle> base = hierarchy_->data().base_faces;
  for (std::size_t f = 0; f < base.size(); ++f)
    if (!base_removed_[f]) out.push_back(base[f]);
  for (const SplitId s : applied_) {
    const SplitStar star = hierarchy_->star(s);
    for (std::uint32_t slot = 0; slot < star.inserted_count(); ++slot)
      if (!removed(s, slot)) out.push_back(star.inserted(slot));
  }
  assert(out.size() == triangles_);
}

}  // namespace occlod
