// Tracks which faces are active while splits are applied.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "occlod/hierarchy.h"

namespace occlod {

// Stores one bit per face of a hierarchy: base faces first, then the faces of each split. O(faces) memory.
class ActiveFaces {
 public:
  explicit ActiveFaces(const Hierarchy& hierarchy);

  // Activates the faces that split s inserts.
  void apply(SplitId s);
  // Deactivates a face. Returns false when the face is not active or does not exist.
  bool remove(const FaceRef& ref);
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] std::size_t face_count() const noexcept { return active_.size(); }  // active or not
  [[nodiscard]] bool active(const FaceRef& ref) const { return active_[place_of(ref)]; }

 private:
  [[nodiscard]] std::size_t place_of(const FaceRef& ref) const {
    return ref.split == no_id ? ref.slot : std::size_t{first_[ref.split]} + ref.slot;
  }

  const Hierarchy& hierarchy_;
  std::vector<std::uint32_t> first_;  // per split, index of its first face; then one more, the total
  std::vector<bool> active_;
  std::size_t count_ = 0;
};

// Returns the corners of the face that ref names.
[[nodiscard]] Triangle face_at(const Hierarchy& hierarchy, const FaceRef& ref);

// Returns true iff both triangles have the same corners in the same rotational order.
[[nodiscard]] bool same_triangle(const Triangle& a, const Triangle& b);

// Returns the faces of the base mesh and of applied splits that no applied split removes: base faces first, then by
// split and slot. `applied` is closed under dependency.
[[nodiscard]] std::vector<Triangle> active_triangles(const Hierarchy& hierarchy, const std::vector<bool>& applied);
// Returns the same faces as active_triangles(), with wedge ids instead of vertex ids.
[[nodiscard]] std::vector<Triangle> active_wedge_triangles(const Hierarchy& hierarchy,
                                                           const std::vector<bool>& applied);

}  // namespace occlod
