// Which faces are active while splits are applied.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "occlod/hierarchy.h"

namespace occlod {

// Removal of every face of a hierarchy as a bit, base faces first, then those of each split. O(faces) memory.
class ActiveFaces {
 public:
  explicit ActiveFaces(const Hierarchy& hierarchy);

  // The faces that s inserts become active.
  void apply(SplitId s);
  // A face stops being active; false when it is not, or is none.
  bool remove(const FaceRef& ref);
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] std::size_t face_count() const noexcept { return active_.size(); }  // active or not
  [[nodiscard]] bool active(const FaceRef& ref) const { return active_[place_of(ref)]; }

 private:
  [[nodiscard]] std::size_t place_of(const FaceRef& ref) const {
    return ref.split == no_id ? ref.slot : std::size_t{first_[ref.split]} + ref.slot;
  }

  const Hierarchy& hierarchy_;
  std::vector<std::uint32_t> first_;  // place of the first face of each split, and the end
  std::vector<bool> active_;
  std::size_t count_ = 0;
};

// The face that ref names.
[[nodiscard]] Triangle face_at(const Hierarchy& hierarchy, const FaceRef& ref);

// True iff both have the same corners in the same rotational order.
[[nodiscard]] bool same_triangle(const Triangle& a, const Triangle& b);

// The faces of the base mesh and of applied splits that no applied split removes: base faces first, then by split and
// slot. `applied` is closed under dependency.
[[nodiscard]] std::vector<Triangle> active_triangles(const Hierarchy& hierarchy, const std::vector<bool>& applied);
// The same by their wedges.
[[nodiscard]] std::vector<Triangle> active_wedge_triangles(const Hierarchy& hierarchy,
                                                           const std::vector<bool>& applied);

}  // namespace occlod
