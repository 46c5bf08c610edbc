// The state of one refined object: which splits are applied. Always closed under dependency.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <unordered_set>
#include <vector>

#include "occlod/hierarchy/hierarchy.h"

namespace occlod {

class Cut {
 public:
  explicit Cut(const Hierarchy& hierarchy);

  // Back to the base mesh. O(applied splits).
  void clear();

  [[nodiscard]] const Hierarchy& hierarchy() const noexcept { return *hierarchy_; }
  [[nodiscard]] bool applied(SplitId s) const noexcept { return (state_[s] & applied_bit) != 0; }
  [[nodiscard]] std::span<const SplitId> applied_splits() const noexcept {
    return applied_;
  }  // in the order of application
  [[nodiscard]] std::size_t triangle_count() const noexcept { return triangles_; }

  // What it takes to apply s: itself and every unapplied split that it needs, directly or not.
  struct Closure {
    std::span<const SplitId> splits;  // valid until the next call
    std::size_t triangles = 0;        // that the cut would gain; splits never lose any on balance
  };
  // Precondition: s is not applied. O(closure). Throws Error when a needed split is damaged.
  [[nodiscard]] Closure closure(SplitId s);
  // Applies what the last closure() found.
  void apply_closure();

  // Active faces: base faces and faces of applied splits that no applied split removes; base faces first, then by
  // split and slot iff `sorted`; sorting also sorts applied_splits().
  void active_triangles(std::vector<Triangle>& out, bool sorted);

 private:
  static constexpr std::uint32_t applied_bit = 1U << 31U;
  static constexpr std::uint32_t closure_bit = 1U << 30U;
  static constexpr std::uint32_t mask_slots = 30;  // low bits: the faces of these slots have been removed

  void remove(const FaceRef& face);
  [[nodiscard]] bool removed(SplitId s, std::uint32_t slot) const;

  const Hierarchy* hierarchy_;
  // Of each split. From calloc: pages that are never touched, of a hierarchy larger than any view, are never there.
  std::unique_ptr<std::uint32_t[], decltype(&std::free)> state_;
  std::vector<bool> base_removed_;                    // of each base face
  std::unordered_set<std::uint64_t> others_removed_;  // split << 32 | slot, of slots that have no bit
  std::vector<SplitId> applied_;
  std::vector<SplitId> closure_;
  std::ptrdiff_t closure_gain_ = 0;
  std::size_t triangles_ = 0;
};

}  // namespace occlod
