// A coarse mesh that has moved little and has the topology of the input: what can stand for the input where it hides.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "occlod/hierarchy.h"

namespace occlod {

// The faces of a cut, and how far what each stands for has moved at most (object units, rounded up).
struct MotionCut {
  std::vector<Triangle> triangles;  // ids of the hierarchy's vertices; base faces first, then by split and slot
  std::vector<float> moved;         // of each
};

// Repeats the recorded collapses from the input on, but leaves out each that would carry anything farther than
// `max_motion` (>= 0, object units) in all, each that would change the topology, and so each whose split one of them
// depends on. What is left is the input after collapses that meet the link condition, each a motion as surface_motion.h
// describes it: take any set S of faces; there is a set S' of the input that the motions carry to S, and its border to
// the border of S, counted modulo 2. For a collapse of v into u, a face at uv belongs to S' iff an odd number of the
// others of S' at its edge through v do. Then that edge is no border; its edge through u is one iff the edge that both
// become is; and uv is one only if some other edge at u is, because the faces at v that do not hold u have an even
// number of edges at v.
//
// So nothing closes and nothing is marked: a window narrower than the motion stays a window. Parts that are left out in
// their entirety, because they are smaller, stay as well. Works whatever error bounds the hierarchy has. Throws Error
// where a mapped file is damaged. O(n log n).
[[nodiscard]] MotionCut cut_to_motion(const Hierarchy& hierarchy, double max_motion);

// How far the surface moves while it is simplified, and where its topology changes on the way.

// Every collapse is a motion that carries the star of v to what is left of it: along the heights between both, or by
// sliding v to u. A cut is what the motions of all splits that are not applied, one after the other, make of the input.
// This bounds how far they carry any point. guaranteed_error bounds distances between surfaces instead; a face may be
// near the input and still far from what it stands for.
//
// *Where a cut is whole.* Take any set S of faces of the cut. There is a set S' of the input that the motions carry to
// S, and its border to the border of S, but for marks. Undo the collapses one by one. Where a collapse keeps the
// topology (the link condition), its motion is one-to-one but for the faces at uv, which it flattens onto an edge each;
// such a face belongs to S' iff the face beyond its other edge at v does. Then every edge has as much of S on either
// side before as after, and uv, which comes to lie in u, is a border only if some edge at u is. Where it does not keep
// the topology, faces at uv and faces that cancel out do not belong to S'. Borders that are new then lie in u or on
// edges from u to vertices that were neighbours of both: these vertices are the marks. A window that closes, a tunnel
// that pinches off and two components that meet leave their outlines there. From then on v is slid wherever v is
// marked, so outlines stay on edges between marked vertices.
//
// *Why any cut.* Splits that are not applied may be undone first, in their order: applied ones do not depend on them.
// What could be different then is that an edge exists that an applied split had taken away; but only a collapse that
// changes the topology does that, and both ends of the edge are marks. So a vertex that is ever a mark is always one.
class SurfaceMotion {
 public:
  // Replays all collapses, from the input to the base mesh. Throws Error where the hierarchy is damaged. O(n log n).
  explicit SurfaceMotion(const Hierarchy& hierarchy);

  // How far what the face stands for has moved at most, object units, rounded up to eight bits; 0 for faces of the
  // input. Infinite where the records contradict themselves.
  [[nodiscard]] float moved(const FaceRef& face) const noexcept {
    const std::size_t place = face.slot + (face.split == no_id ? std::size_t{0} : first_face_[face.split]);
    return std::bit_cast<float>(std::uint32_t{moved_[place]} << 16U);
  }
  // Whether a vertex of a cut, or anything merged into it, is a mark, given the first split of its chain (its root or
  // child_v, then child_u) that is not applied, or no_id.
  [[nodiscard]] bool is_marked(VertexId v, SplitId first_left) const noexcept {
    return marked_[v] || (first_left != no_id && marks_below_[first_left]);
  }
  // Collapses that change the topology.
  [[nodiscard]] std::size_t topology_changes() const noexcept { return topology_changes_; }

 private:
  class Replay;

  std::vector<std::uint32_t> first_face_;  // of splits, among all faces; those of the base mesh come first
  std::vector<std::uint16_t> moved_;       // of faces: the upper halves of floats
  std::vector<bool> marked_;               // of vertices
  std::vector<bool> marks_below_;          // of splits: their vertices and everything below them in the forest
  std::size_t topology_changes_ = 0;
};

// That of the hierarchy. Made anew unless somebody holds it: whoever does keeps the hierarchy's arrays alive as well.
// Any thread may ask.
[[nodiscard]] std::shared_ptr<const SurfaceMotion> motion_of(const Hierarchy& hierarchy);

}  // namespace occlod
