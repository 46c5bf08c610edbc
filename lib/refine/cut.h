// Holds which splits of the objects are applied. The set is always closed under dependency.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "base/memory.h"
#include "base/platform.h"
#include "occlod/hierarchy.h"
#include "splits/star.h"

namespace occlod {

class Cut {
 public:
  explicit Cut(const Hierarchy& hierarchy);

  // Returns to the base mesh. O(applied splits).
  void clear();

  [[nodiscard]] const Hierarchy& hierarchy() const noexcept { return *hierarchy_; }
  [[nodiscard]] bool applied(SplitId s) const noexcept { return (state_[s] & applied_bit) != 0; }
  // Returns applied splits in the order of application until active_triangles() sorts them. Splits that have been taken
  // back stay listed until active_triangles() drops them.
  [[nodiscard]] std::span<const SplitId> applied_splits() const noexcept { return applied_; }
  [[nodiscard]] std::size_t triangle_count() const noexcept { return triangles_; }

  // Lists what it takes to apply s: s itself and every unapplied split that it needs, directly or not.
  struct Closure {
    std::span<const SplitId> splits;  // valid until the next call
    std::size_t triangles = 0;        // net number that the cut would gain, never negative
  };
  // Returns the closure of s. Precondition: s is not applied. O(closure). Throws Error when a needed split is damaged.
  [[nodiscard]] Closure closure(SplitId s);
  // Prefetches what a coming closure(s) reads. The star of s should be in the caches already.
  void prefetch_needs(SplitId s) const noexcept {
    prefetch(&state_[s]);
    for (const SplitId needed : star_of(*hierarchy_, s).dependencies()) prefetch(&state_[needed]);
  }
  // Applies the result of the last closure(). Throws Error when a split removes a face that another has removed; only
  // clear() may follow.
  void apply_closure();

  // Returns whether no applied split needs s. Precondition: s is applied.
  [[nodiscard]] bool is_leaf(SplitId s) const;
  // Returns how many faces that s inserts have been removed by applied splits. Precondition: s is applied.
  [[nodiscard]] std::uint32_t removed_faces(SplitId s) const;
  // Takes back a split. Precondition: it is a leaf.
  void take_back(SplitId s);

  // Applies these splits, which are ascending, and all that they need, and no other: takes back and applies only what
  // differs. O(splits applied before and after), some nanoseconds each, and what apply_closure() takes for each that
  // differs. Throws Error as closure() and apply_closure() do, and is then the base mesh.
  void set(std::span<const SplitId> splits);

  // Writes the active faces: faces of the base mesh and of applied splits that no applied split removes. Base faces
  // come first; iff `sorted`, the others follow by split and slot, and applied_splits() is sorted as well.
  void active_triangles(std::vector<Triangle>& out, bool sorted);
  // Writes the same faces with wedge ids, as they are drawn.
  void active_wedge_triangles(std::vector<Triangle>& out, bool sorted);
  // Calls visit(FaceRef, Triangle) for each active face in the order of applied_splits().
  template <typename Visit>
  void for_each_active(const Visit& visit) const;
  // Does so for the faces of applied_splits()[begin, end), and for those of the base mesh if `begin` is 0.
  template <typename Visit>
  void for_each_active(std::size_t begin, std::size_t end, const Visit& visit) const;
  // Drops splits from applied_splits() that have been taken back. O(applied splits) if there are any.
  void drop_taken_back();

 private:
  static constexpr std::uint32_t applied_bit = 1U << 31U;
  static constexpr std::uint32_t closure_bit = 1U << 30U;
  static constexpr std::uint32_t listed_bit = 1U << 29U;  // is in applied_, where a split stays after it is taken back
  static constexpr std::uint32_t mask_slots = 29;  // low bits: whether the faces of these slots have been removed
  static constexpr std::uint32_t mask_bits = (1U << mask_slots) - 1;

  [[nodiscard]] bool needs_no_other(const SplitStar& star) const;
  void apply(SplitId s);
  void sort_applied();
  void set_removed(const FaceRef& face, bool removed);
  [[nodiscard]] bool removed(const FaceRef& face) const;
  [[nodiscard]] bool removed(SplitId s, std::uint32_t slot) const;
  // Calls visit(SplitId) for each split that s needs only for a corner, without removing a face of it.
  template <typename Visit>
  void for_each_corner_need(const SplitStar& star, const Visit& visit);

  const Hierarchy* hierarchy_;
  ZeroedArray<std::uint32_t> state_;                         // per split
  std::vector<bool> base_removed_;                           // per base face
  std::unordered_set<std::uint64_t> others_removed_;         // split << 32 | slot, for slots without a bit
  std::unordered_map<SplitId, std::uint32_t> corner_needs_;  // how many applied splits need this one for a corner alone
  std::vector<SplitId> applied_;                             // also splits that have been taken back, if any
  bool some_taken_back_ = false;
  std::vector<SplitId> closure_;
  std::vector<SplitId> removed_from_, sorting_;  // scratch
  std::ptrdiff_t closure_gain_ = 0;
  std::size_t triangles_ = 0;
};

template <typename Visit>
void Cut::for_each_active(const Visit& visit) const {
  for_each_active(0, applied_.size(), visit);
}

template <typename Visit>
void Cut::for_each_active(std::size_t begin, std::size_t end, const Visit& visit) const {
  const std::span<const Triangle> base = hierarchy_->data().base_faces;
  for (std::uint32_t f = 0; begin == 0 && f < base.size(); ++f)
    if (!base_removed_[f]) visit(FaceRef{no_id, f}, base[f]);
  for (std::size_t i = begin; i < end; ++i) {
    prefetch_stars_after(*hierarchy_, applied_, i);
    const SplitId s = applied_[i];
    if (!applied(s)) continue;
    const SplitStar star = star_of(*hierarchy_, s);
    const std::uint32_t in_mask = std::min(star.inserted_count(), mask_slots);
    for (std::uint32_t left = ~state_[s] & ((1U << in_mask) - 1); left != 0; left &= left - 1) {
      const auto slot = static_cast<std::uint32_t>(std::countr_zero(left));
      visit(FaceRef{s, slot}, star.inserted(slot));
    }
    for (std::uint32_t slot = mask_slots; slot < star.inserted_count(); ++slot)
      if (!removed(s, slot)) visit(FaceRef{s, slot}, star.inserted(slot));
  }
}

// Holds the cuts of all objects, which share one budget, and the number of their triangles.
class CutSet {
 public:
  void add(const Hierarchy& hierarchy);

  // Returns to the base meshes. O(applied splits).
  void clear();

  [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(cuts_.size()); }
  [[nodiscard]] const Cut& operator[](std::uint32_t object) const noexcept { return cuts_[object]; }
  [[nodiscard]] const Hierarchy& hierarchy(std::uint32_t object) const noexcept { return cuts_[object].hierarchy(); }
  [[nodiscard]] std::size_t triangle_count() const noexcept { return triangles_; }
  [[nodiscard]] std::size_t base_triangle_count() const noexcept { return base_triangles_; }

  // These do for one object what those of Cut do.
  [[nodiscard]] Cut::Closure closure(std::uint32_t object, SplitId s) { return cuts_[object].closure(s); }
  void apply_closure(std::uint32_t object);
  void drop_taken_back(std::uint32_t object) { cuts_[object].drop_taken_back(); }
  void active_triangles(std::uint32_t object, std::vector<Triangle>& out, bool sorted) {
    cuts_[object].active_triangles(out, sorted);
  }
  void active_wedge_triangles(std::uint32_t object, std::vector<Triangle>& out, bool sorted) {
    cuts_[object].active_wedge_triangles(out, sorted);
  }

  // Takes a leaf back, then calls visit_leaf(SplitId) for each split that has become a leaf thereby.
  template <typename Visit>
  void take_back(std::uint32_t object, SplitId s, const Visit& visit_leaf);

 private:
  std::vector<Cut> cuts_;
  std::size_t triangles_ = 0;
  std::size_t base_triangles_ = 0;
};

inline void CutSet::add(const Hierarchy& hierarchy) {
  cuts_.emplace_back(hierarchy);
  triangles_ += hierarchy.base_triangle_count();
  base_triangles_ += hierarchy.base_triangle_count();
}

inline void CutSet::clear() {
  for (Cut& cut : cuts_) cut.clear();
  triangles_ = base_triangles_;
}

inline void CutSet::apply_closure(std::uint32_t object) {
  Cut& cut = cuts_[object];
  triangles_ -= cut.triangle_count();
  cut.apply_closure();
  triangles_ += cut.triangle_count();
}

template <typename Visit>
void CutSet::take_back(std::uint32_t object, SplitId s, const Visit& visit_leaf) {
  Cut& cut = cuts_[object];
  triangles_ -= cut.triangle_count();
  cut.take_back(s);
  triangles_ += cut.triangle_count();
  for (const SplitId needed : star_of(cut.hierarchy(), s).dependencies())
    if (cut.is_leaf(needed)) visit_leaf(needed);
}

}  // namespace occlod
