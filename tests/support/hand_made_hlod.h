// HLODs made by hand, of panels: rectangles that face +z and share no vertex, each on its own way up the levels.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/hlod.h"
#include "occlod/view.h"

namespace occlod::test {

// Four triangles on level 0, two on level 1 (the whole rectangle still), one on all coarser levels (half of it).
struct Panel {
  glm::vec3 min{0.0F};              // its corner with the least x and y; object space
  glm::vec2 size{1.0F};             // along x and y, > 0
  std::vector<hlod::NodeId> nodes;  // which it belongs to, from level 0 to the coarsest; as many for all panels
};

// Node n has errors[n]; nodes are numbered level by level, the coarsest first. Passes validate().
[[nodiscard]] hlod::Hlod hand_made_hlod(std::span<const Panel> panels, std::span<const float> errors);

// A tree of nine nodes over panels in two rows, one 4 behind the other; if asked for, the last panel of the second row
// rises above the first:
//
//          0                    z = 0: nodes 3, 4, 5 from left to right, 6 wide and 2 high together, without a gap
//        /   \                  z = -4: nodes 6, 7, 8 behind them, 1.2 wide and high; from (-2, 0, 10) they are hidden
//     1         2
//   / | \     / | \             errors: 2 of node 0, 1 of nodes 1 and 2
//  3  4  5   6  7  8
[[nodiscard]] hlod::Hlod two_rows(bool last_rises = false);

// 100 x 100 pixels at 90 degrees: an object unit at distance 1 covers 50 pixels.
[[nodiscard]] Camera square_camera(const glm::dvec3& eye, const glm::dvec3& target);
// From (-2, 0, 10) along -z: sees the first row only.
[[nodiscard]] Camera camera_ahead();

// Nine nodes, one of which has two parents: the panels of 7 and 4 belong to 1 in their left half, to 2 in their right.
//
//       0          level 3
//     /   \                        errors: 3 of node 0, 2 of 1 and 2, 1 of 3, 4 and 5
//    1     2       level 2
//   / \   / \                      panels at z = 0: nodes 6, 7, 8 from left to right
//  3    4    5     level 1
//  |    |    |
//  6    7    8     level 0
[[nodiscard]] hlod::Hlod shared_child();

// Nine nodes: one that has two parents, which have one parent each. The panels of 7 and 5 belong to 3 in their left
// half, to 4 in their right.
//
//    0       level 4
//   / |
//  1  2      level 3              errors: 4 of node 0, 3 of 1 and 2, 2 of 3 and 4, 1 of 5 and 6
//  |  |
//  3  4      level 2
//  | /|
//  5  6      level 1
//  |  |
//  7  8      level 0              panels at z = 0: nodes 7 and 8 from left to right
[[nodiscard]] hlod::Hlod shared_grandchild();

// One panel of one level.
[[nodiscard]] hlod::Hlod one_panel(const glm::vec3& min, const glm::vec2& size);

}  // namespace occlod::test
