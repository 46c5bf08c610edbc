// Walking through view cells: what to draw from frame to frame, from a .vlod file, without waiting for the disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "occlod/bounds.h"
#include "occlod/refiner.h"
#include "occlod/view.h"
#include "occlod/vlod_file.h"

namespace occlod {

// How a walk runs.
struct WalkOptions {
  // Bytes that may be in memory of what nodes add, of triangles to draw, and of the geometry of a packed file: a hard
  // limit, but for what is just being loaded. What all cells have in common is always there.
  std::size_t memory = std::size_t{256} << 20U;
  int loaders = 1;  // threads that load, in [0, 64]; 0: none, a CellLoader has to
};

// Neighbours among the triangles of an object.
struct TriangleBlock {
  Box box;                  // around them, object space
  std::uint32_t first = 0;  // index of the first one
  std::uint32_t count = 0;  // >= 1
};

// What to draw of one object; valid until the next step.
struct WalkedObject {
  std::span<const Triangle> triangles;             // ids of these wedges, in no particular order
  std::span<const TriangleBlock> blocks;           // all triangles, block by block
  std::span<const glm::vec3> positions;            // object space: of the hierarchy, or of a packed file those of this
                                                   // cell; one for each wedge
  std::span<const glm::vec3> normals;              // one for each wedge, or none
  std::span<const glm::u8vec4> colors;             // likewise
  std::span<const glm::vec2> texture_coordinates;  // likewise
  std::span<const MaterialId> wedge_materials;     // likewise, of the faces there; none: all have the first, if any
  SurfaceMaterials surface;                        // that wedge_materials index: of the hierarchy, or of the file
};

// What step() gives; valid until its next call.
struct WalkedFrame {
  CellId cell = no_id;    // the leaf where the eye is, or that nearest to it
  CellId shown = no_id;   // whose cut is drawn: `cell`, or a node above it
  bool outside = false;   // the eye is in no leaf: nothing is promised
  bool crossed = false;   // `cell` is another than in the frame before
  bool changed = false;   // what is drawn is
  bool late = false;      // `shown` is not `cell`: its cut is not there yet
  bool missing = false;   // late, and it will not come: it cannot be read, or needs more memory than there may be
  double error_px = 0.0;  // how far anything seen from `cell` is from what is drawn, at most, as CellCut::error_px; of
                          // what is hidden too where the frame is late
  std::size_t drawn_triangles = 0;    // of all objects
  std::uint64_t bytes_read = 0;       // of the file, by loads that have ended since the step before
  std::size_t loads = 0;              // that have ended since
  std::size_t resident_bytes = 0;     // of what WalkOptions::memory limits
  std::vector<WalkedObject> objects;  // as given to the walker, or as the file has them
  std::vector<std::string> notes;     // what could not be loaded, one line each; told once
  // As long as it is kept, what `objects` point to stays as it is, whatever the walker does, but for hierarchies and
  // `surface`, which belong to whoever made them and to the file.
  std::shared_ptr<const void> owner;
};

// A part of the triangles of an object.
struct ObjectRange {
  std::uint32_t object = 0;  // index of the object
  std::uint32_t first = 0;   // index into its triangles
  std::uint32_t count = 0;   // of triangles, >= 1
};

// Finds the blocks of a frame that may be inside the frustum, neighbouring ones joined. Clears `out`. O(blocks).
void ranges_in_view(const WalkedFrame& frame, std::span<const RefineObject> objects, const View& view,
                    std::vector<ObjectRange>& out);

// Returns the objects of a file, without hierarchies: for ranges_in_view() of a walk through a packed file.
[[nodiscard]] std::vector<RefineObject> placements(const VlodFile& file);

class CellLoader;
struct WalkTrial;

// Chooses what to draw in each frame. Loads ahead what the motion of the eye makes likely, in other threads; a cell is
// prepared there as a whole, and shown when it is ready. Until then the cut of the deepest node above it that is there
// is drawn, all of whose splits the cell has too, with its error (docs/guide/view_cells.md#walking).
class CellWalker {
 public:
  // Walks through a file; `objects` are those that it was opened with; their hierarchies outlive the walker. Reads what
  // all cells have in common. Throws Error when that cannot be read or options are out of their range: then the least
  // memory is named.
  CellWalker(std::shared_ptr<const VlodFile> file, std::span<const RefineObject> objects,
             const WalkOptions& options = {});
  // Walks through a packed file that was opened without objects: no hierarchies are needed.
  explicit CellWalker(std::shared_ptr<const VlodFile> file, const WalkOptions& options = {});
  // Waits for reads that have begun.
  ~CellWalker();
  CellWalker(const CellWalker&) = delete;
  CellWalker& operator=(const CellWalker&) = delete;

  // Goes on to this eye (world space, finite), `seconds` >= 0 after the step before. Never waits for the disk, reads,
  // or throws because of it. O(cells that may be entered soon), microseconds.
  const WalkedFrame& step(const glm::dvec3& eye, double seconds);

  // Varies the walk for simulated disks and tests, before the first step.
  void set_trial(WalkTrial trial);

 private:
  friend class CellLoader;
  class Work;
  std::unique_ptr<Work> work_;
};

// Loads for a walker without loaders of its own, when it is told to: for simulated disks and for tests. One thread
// each. The walker outlives it.
class CellLoader {
 public:
  // Loads for a walker with WalkOptions::loaders = 0, or beside its own.
  explicit CellLoader(CellWalker& walker);
  ~CellLoader();
  CellLoader(const CellLoader&) = delete;
  CellLoader& operator=(const CellLoader&) = delete;

  // Takes what is wanted most, reads and prepares it. False: nothing is. finish() has to follow.
  bool begin();
  // Hands it to the walker, whose next step may show it.
  void finish();

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace occlod
