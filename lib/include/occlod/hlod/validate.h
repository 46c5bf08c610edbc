// The invariants of an HLOD, checked without trusting anything in it. Tests call this after every build and load.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "occlod/hlod/hlod.h"
#include "occlod/hlod/triangle_source.h"

namespace occlod::hlod {

// Checks that sizes and indices of the arrays fit together, so that an Hlod made from them can be traversed safely:
// levels are runs of nodes, patches divide a node's triangles and name parents one level up, children are the nodes
// whose patches name them, meshes and splits lie within their arrays. Meshes and splits are not looked at. Returns what
// is wrong, or nothing. O(nodes + patches).
[[nodiscard]] std::optional<std::string> check_structure(const HlodView& data);

// Checks that the mesh of node n can be drawn: indices and merged_into in range, positions finite. `data` has passed
// check_structure(). Returns what is wrong, or nothing. O(size of the mesh).
[[nodiscard]] std::optional<std::string> check_mesh(const HlodView& data, NodeId n);

// The same for its splits: their parents come before them, errors are finite and descend. O(size of the splits).
[[nodiscard]] std::optional<std::string> check_within(const HlodView& data, NodeId n);

// How thoroughly validate() looks.
struct ValidateOptions {
  std::size_t random_fronts = 64;  // random legal fronts whose boundary is compared with the input's
};

// Checks five invariants: (1) no error is smaller than a child's, and boxes and spheres contain what they say; (2) all
// vertices of a node are vertices of its children; (3) the triangles of a node are those of its children that it
// replaces, with its merges applied, where degenerate ones vanish and opposite ones cancel; (4) where borders are
// locked, every vertex is merged in one node only, and the oriented boundary of random legal fronts is that of the
// input with the merges of all coarser nodes applied: no crack opens between nodes of different levels; (5) of nodes
// with splits, all splits together give the triangles that the node was made from, and none of them its mesh, triangle
// for triangle; their errors descend from that of the node; and (4) holds too for fronts on which nodes whose parents
// are all refined are drawn with a random number of their splits. Returns one line per violation (at most 20), none
// when all hold. Throws Error when a mapped file is damaged. O(size + nodes * random_fronts); with splits O(size *
// random_fronts).
[[nodiscard]] std::vector<std::string> validate(const Hlod& hlod, const ValidateOptions& options = {});

// True iff the nodes of level 0 together are exactly the triangles of `mesh`, rounded to the HLOD's lattice and cleaned
// if it has one: the same positions in the same rotational order, each as often, with the same material and, at each
// corner, the same of those attributes that the mesh has, to the bit. O(n log n).
[[nodiscard]] bool restores(const Hlod& hlod, const TriangleMesh& mesh);

// The same of a source, whose pieces are read once: compares how many triangles there are, and sums of hashes (128
// bits) of their positions alone. Triangles with two corners at one place do not count. Meshes of the HLOD are checked
// one by one; O(n) time, memory for one piece.
[[nodiscard]] bool restores(const Hlod& hlod, const TriangleSource& source);

}  // namespace occlod::hlod
