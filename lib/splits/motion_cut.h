// A coarse mesh that has moved little and has the topology of the input: what can stand for the input where it hides.
#pragma once

#include <vector>

#include "occlod/hierarchy/hierarchy.h"

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

// What is left out, for tests: then the cut is not what it promises.
struct MotionCutWithout {
  bool topology = false;  // collapses that change the topology are repeated as well
};
[[nodiscard]] MotionCut cut_to_motion(const Hierarchy& hierarchy, double max_motion, const MotionCutWithout& without);

}  // namespace occlod
