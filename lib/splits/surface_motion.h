// Makes a coarse mesh that has moved little and has the topology of the input, so that it can replace the input as an
// occluder.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "occlod/hierarchy.h"

namespace occlod {

// Holds the faces of a cut, and for each a bound on how far the surface it represents has moved (object units, rounded
// up).
struct MotionCut {
  std::vector<Triangle> triangles;  // ids of the hierarchy's vertices; base faces first, then by split and slot
  std::vector<float> moved;         // per face
};

// Repeats the recorded collapses from the input on, but leaves out each that would carry any point farther than
// `max_motion` (>= 0, object units) in total, each that would change the topology, and each whose split one of the left
// out splits depends on. The result is the input after collapses that meet the link condition, each of which is a
// motion as described at SurfaceMotion. For any set S of faces there is a set S' of the input that the motions carry to
// S, and whose border they carry to the border of S, counted modulo 2. For a collapse of v into u, a face at edge uv
// belongs to S' iff an odd number of the other faces of S' at the face's edge through v do. Then that edge is no
// border; the face's edge through u is one iff the edge that both become is; and uv is one only if some other edge at u
// is, because the faces at v that do not contain u have an even number of edges at v.
//
// So no window closes and no vertex is marked: a window narrower than the motion stays open. Components that are left
// out entirely, because they are smaller, stay as well. Works with any error bounds of the hierarchy. Throws Error
// where a mapped file is damaged. O(n log n).
[[nodiscard]] MotionCut cut_to_motion(const Hierarchy& hierarchy, double max_motion);

// Bounds how far the surface moves while it is simplified, and marks where its topology changes.

// Every collapse is a motion that carries the star of v to the faces that replace it: along the heights between both,
// or by sliding v to u. A cut is the input moved by the motions of all splits that are not applied, one after the
// other. This class bounds how far they carry any point. guaranteed_error bounds distances between surfaces instead; a
// face may be near the input and still far from the part of it that the face represents.
//
// *Where a cut has no new holes.* For any set S of faces of the cut there is a set S' of the input that the motions
// carry to S, and whose border they carry to the border of S, except at marks. To see this, undo the collapses one by
// one. Where a collapse keeps the topology (the link condition), its motion is one-to-one except for the faces at uv,
// each of which it flattens onto an edge; such a face belongs to S' iff the face beyond its other edge at v does. Then
// every edge has as much of S on either side as before, and uv, which is moved to u, is a border only if some edge at u
// is. Where a collapse does not keep the topology, faces at uv and faces that cancel out do not belong to S'. New
// borders then lie in u or on edges from u to vertices that were neighbours of both ends: these vertices are the marks.
// A window that closes, a tunnel that pinches off and two components that meet leave their outlines there. From then on
// a marked v is always slid, so outlines stay on edges between marked vertices.
//
// *Why this holds for any cut.* Splits that are not applied may be undone first, in their order, because applied splits
// do not depend on them. The only possible difference is an edge that an applied split had removed; but only a collapse
// that changes the topology removes such an edge, and both of its ends are marks. So a vertex that is ever a mark is
// treated as one always.
class SurfaceMotion {
 public:
  // Replays all collapses, from the input to the base mesh. Throws Error where the hierarchy is damaged. O(n log n).
  explicit SurfaceMotion(const Hierarchy& hierarchy);

  // Returns a bound on how far the surface that the face represents has moved, in object units, rounded up to eight
  // bits; 0 for faces of the input. Infinite where the records contradict themselves.
  [[nodiscard]] float moved(const FaceRef& face) const noexcept {
    const std::size_t place = face.slot + (face.split == no_id ? std::size_t{0} : first_face_[face.split]);
    return std::bit_cast<float>(std::uint32_t{moved_[place]} << 16U);
  }
  // Returns whether a vertex of a cut, or anything merged into it, is a mark, given the first split of its chain (its
  // root or child_v, then child_u) that is not applied, or no_id.
  [[nodiscard]] bool is_marked(VertexId v, SplitId first_left) const noexcept {
    return marked_[v] || (first_left != no_id && marks_below_[first_left]);
  }
  // Returns the number of collapses that change the topology.
  [[nodiscard]] std::size_t topology_changes() const noexcept { return topology_changes_; }

 private:
  class Replay;

  std::vector<std::uint32_t> first_face_;  // per split, among all faces; those of the base mesh come first
  std::vector<std::uint16_t> moved_;       // per face: the upper halves of floats
  std::vector<bool> marked_;               // per vertex
  std::vector<bool> marks_below_;          // per split: its vertices and everything below them in the forest
  std::size_t topology_changes_ = 0;
};

// Returns the motion of the hierarchy. It is recomputed unless somebody still holds it; holding it keeps the
// hierarchy's arrays alive as well. Thread-safe.
[[nodiscard]] std::shared_ptr<const SurfaceMotion> motion_of(const Hierarchy& hierarchy);

}  // namespace occlod
