// Builds hierarchical levels of detail: groups of triangles by octrees, each simplified by half-edge collapses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "occlod/build_hierarchy.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"

namespace occlod::hlod {

// What lies between a node and its parents.
enum class Within {
  geomorph,  // NodeMesh::merged_into: vertices can slide to the parent's
  splits,    // also every node's collapses: it can be drawn with any number of them undone (NodeCut), for twice the
             // bytes; vertices stay where the input has them
};

// Has other processes simplify the groups of a build, which takes most of its time. Each task is a file with all that
// the groups of one part of a level depend on; the result is a file beside it. A build takes results over that it
// finds, also those of an earlier build that ended, and removes the files of what it has joined.
struct HlodParts {
  // A folder that all processes see; empty: the build simplifies its groups itself.
  std::filesystem::path folder = {};
  // Called with the file of a task: has simplify_part() called in some process. Need not wait for it.
  std::function<void(const std::filesystem::path& task)> start = {};
  // Called once for each task that was started, in the same order: returns when simplify_part() has. What either throws
  // ends the build.
  std::function<void(const std::filesystem::path& task)> finish = {};
};

// How an HLOD is built.
struct HlodBuildOptions {
  std::uint32_t node_triangles = 2000;    // the most that a node of level 0 has; groups of four times as many are
                                          // simplified to about a quarter; in [16, 4096]
  Grouping grouping = Grouping::shifted;  // how triangles are grouped from level to level
  Borders borders = Borders::locked;      // what happens at the borders of groups; `free` with nested groups only
  Within within = Within::geomorph;       // what is kept for the way from a node to its parent
  // How Node::guaranteed_error is computed; measured takes about twice as long. Tilesets are refined by it.
  ErrorBound error_bound = ErrorBound::accumulated;
  // 0: positions stay as they are; in [8, 23]: they are rounded to a lattice of so many bits for the longest side of
  // the mesh's box, so that files take fewer bytes. What falls together is cleaned.
  // All errors are relative to the rounded mesh.
  int quantise_bits = 0;
  int threads = 0;  // in [0, 1024]; 0: one for each core. The result does not depend on it
  // A file in which a build keeps what it has finished; empty: none. A build of the same mesh with the same options
  // goes on from there, to the same bytes; threads may differ, and so may the limit of memory, though not whether the
  // mesh comes from a TriangleSource. It is made where there is none, takes about 18 bytes a triangle of the input, and
  // stays when the build ends: remove it once the result is written. What is damaged or cut off at its end is done
  // again. Error for a file that is no journal, that another build uses, or that does not fit.
  std::filesystem::path journal = {};
  // Who simplifies groups. The result does not depend on it.
  HlodParts parts = {};
  // Called now and then on the calling thread with the share done, in [0, 1], at last with 1; returning false cancels
  // the build, which then throws Error. What it throws ends the build too.
  std::function<bool(double)> progress = {};
};

// Builds the HLOD of any triangle soup that clean() accepts; the same mesh and options give the same bytes, whatever
// the number of threads. Throws Error for an option out of its range or free borders of shifted groups, for a mesh
// without triangles, with an index out of range, with two vertices at one position or a position that is not finite or
// has a coordinate beyond farthest_coordinate, and when cancelled. O(n log n) time; about 100 bytes a triangle beside
// the result while building.
[[nodiscard]] Hlod build_hlod(const TriangleMesh& mesh, const HlodBuildOptions& options = {});
// Builds the same, and counts in `report`, that of the mesh, what rounding to a lattice changes.
[[nodiscard]] Hlod build_hlod(const TriangleMesh& mesh, const HlodBuildOptions& options, MeshReport& report);

// Builds the same from a source that is read once, for meshes larger than memory: keep a MemoryLimit (occlod/base.h)
// while this runs and while the result is written. Vertices of all pieces at one position become one, triangles with
// two corners at one place and vertices without triangles go, as clean() has it; `report` is filled in as
// clean() of the whole mesh does, with the counts of reading that the source tells. The bytes are those of build_hlod()
// of the cleaned mesh. Throws Error as above, for what pieces throw, and for 2^32 or more vertices or triangles.
[[nodiscard]] Hlod build_hlod(const TriangleSource& source, const HlodBuildOptions& options, MeshReport& report);

// Simplifies the groups of a task of HlodParts and writes the result, which appears whole or not at all. Does nothing
// where that is there already. `threads` as in HlodBuildOptions. Throws Error for a file that is no task, is damaged or
// of another version of occlod, and when the result cannot be written. O(n log n) within each group.
void simplify_part(const std::filesystem::path& task, int threads = 0);

// Refinement within nodes (Charalambos 2006, sec. 4.4): the mesh of a node with some of its collapses undone, so that
// its error is anything between its own and its children's. For HLODs built with Within::splits.

// A node's mesh with its first splits applied. It may be drawn in place of the node when all the node's parents are
// refined, or else not drawn and out of sight: it has no patches. Whatever its neighbours are drawn with, no gap opens
// where borders are locked (docs/internals/decisions.md#29-cuts-within-nodes).
struct NodeCut {
  std::uint32_t splits = 0;            // how many; 0: the node's mesh as it is
  std::vector<std::uint16_t> indices;  // three for each triangle: into NodeMesh::positions, then NodeSplits::positions
};

// Returns how many splits leave an error of at most `max_error` (object units): none when that is Node::error or more,
// all that change anything when it is Node::child_error or less. 0 for a node without splits, which else have been
// required. O(log splits).
[[nodiscard]] std::uint32_t splits_to_error(const Hlod& hlod, NodeId n, double max_error);

// Returns the error of drawing node n with its first splits applied instead of the input: between Node::child_error and
// Node::error. splits <= NodeWithin::splits; the node's splits have been required. O(1).
[[nodiscard]] double error_of_splits(const Hlod& hlod, NodeId n, std::uint32_t splits);

// Returns the mesh of node n, which has_within() and whose splits have been required, with its first splits applied, or
// some more where the last one is of a place that others are at. O(triangles that the node was made from), times their
// logarithm where the input has seams.
[[nodiscard]] NodeCut cut_with_splits(const Hlod& hlod, NodeId n, std::uint32_t splits);

// Returns the coarsest mesh of node n whose error is at most `max_error`, object units; the finest if none is. Requires
// what it needs, so it throws Error when a mapped file is damaged. O(triangles that the node was made from).
[[nodiscard]] NodeCut within_cut(const Hlod& hlod, NodeId n, double max_error);

// Returns the largest 2^(i/4), i an integer, that is at most x; 0 for 0. x >= 0; of infinity the largest that is
// finite.
[[nodiscard]] double error_step(double x);

// Cuts of nodes, kept from frame to frame. Errors are rounded down to error_step(), so that a node's cut changes only
// when its error has changed by a fifth. One thread at a time.
class CutCache {
 public:
  // Starts empty.
  explicit CutCache(std::size_t max_bytes = std::size_t{64} << 20U);
  CutCache(CutCache&&) noexcept;
  CutCache& operator=(CutCache&&) noexcept;
  ~CutCache();

  // Starts a frame: drops cuts, the longest unused first, while all have more than `max_bytes`.
  void begin_frame();
  // Returns within_cut() to error_step(max_error). Valid until the next begin_frame(). `hlod` stays where it is as long
  // as the cache is used; cuts without splits have no indices: draw the node's own. Throws Error when a mapped file is
  // damaged.
  [[nodiscard]] const NodeCut& get(const Hlod& hlod, NodeId n, double max_error);
  // Returns the bytes of all cuts that are kept.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod::hlod
