// The cuts of all objects, which share one budget.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "refine/cut.h"

namespace occlod {

// Knows how many triangles all of them have.
class CutSet {
 public:
  void add(const Hierarchy& hierarchy);

  // All back to their base meshes. O(applied splits).
  void clear();

  [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(cuts_.size()); }
  [[nodiscard]] const Cut& operator[](std::uint32_t object) const noexcept { return cuts_[object]; }
  [[nodiscard]] const Hierarchy& hierarchy(std::uint32_t object) const noexcept { return cuts_[object].hierarchy(); }
  [[nodiscard]] std::size_t triangle_count() const noexcept { return triangles_; }
  [[nodiscard]] std::size_t base_triangle_count() const noexcept { return base_triangles_; }

  // As those of Cut.
  [[nodiscard]] Cut::Closure closure(std::uint32_t object, SplitId s) { return cuts_[object].closure(s); }
  void apply_closure(std::uint32_t object);
  void active_triangles(std::uint32_t object, std::vector<Triangle>& out, bool sorted) {
    cuts_[object].active_triangles(out, sorted);
  }
  void active_wedge_triangles(std::uint32_t object, std::vector<Triangle>& out, bool sorted) {
    cuts_[object].active_wedge_triangles(out, sorted);
  }

  // Takes a leaf back, then calls visit_leaf(SplitId) for each split that this has made a leaf.
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
  for (const SplitId needed : cut.hierarchy().star(s).dependencies())
    if (cut.is_leaf(needed)) visit_leaf(needed);
}

}  // namespace occlod
