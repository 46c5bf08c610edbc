// Tracks which cells a walker wants loaded and which have been loaded; shared by the walker and its loaders.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cells/cell_mesh.h"
#include "occlod/cell_walker.h"
#include "occlod/vlod_file.h"

namespace occlod {

// What a node adds: as VlodFile::read(), which it calls in the end. Any number of threads may call it.
using CellReader = std::function<CellAdditions(CellId cell, std::span<const CellAdditions* const> ancestors)>;

// How a walk may be varied for simulated disks and tests, by CellWalker::set_trial().
struct WalkTrial {
  CellReader reader = {};  // instead of VlodFile::read(), if there is one
  // Called before geometry of a packed file is read, with its bytes, on the thread that reads.
  std::function<void(std::uint64_t bytes)> before_geometry = {};
  bool prefetch = true;  // cells are loaded before the eye is in them
};

using SharedAdditions = std::shared_ptr<const CellAdditions>;

// Describes a load that has ended.
struct CellLoad {
  CellId cell = no_id;
  std::shared_ptr<const CellMesh> mesh;                       // null where it failed
  std::vector<std::pair<CellId, SharedAdditions>> additions;  // read for it, of nodes that have children
  std::uint64_t bytes_read = 0;                               // from the file
  CellId failed = no_id;                                      // node that could not be read, on the path to `cell`
  std::string problem;                                        // one line
};

// Thread-safe. Locks are held only for look-ups, never while anything is read or prepared.
class CellLoads {
 public:
  explicit CellLoads(const VlodFile& file) : file_(file) {}

  // Before anything is wanted: reads by this instead of the file.
  void set_reader(CellReader reader) { reader_ = std::move(reader); }

  // For loaders: returns the most urgent cell that nobody loads yet. take_or_wait() waits for one, and returns nothing
  // when no more will come.
  [[nodiscard]] std::optional<CellId> take();
  [[nodiscard]] std::optional<CellId> take_or_wait();
  // Reads what is missing of the path to the cell, and prepares the cell. Does not throw.
  [[nodiscard]] CellLoad load(CellId cell, CellMeshMaker& maker) const;
  void finish(CellLoad load);

  // For the walker: replaces the list of wanted cells, the most urgent first.
  void want(std::span<const CellId> cells);
  // Returns in `out` what has ended since the last call. Clears `out` first.
  void collect(std::vector<CellLoad>& out);
  [[nodiscard]] std::size_t addition_bytes() const;
  // Drops the additions of all nodes that are not on the path.
  void keep_additions(std::span<const CellId> path);
  void stop();

 private:
  [[nodiscard]] std::optional<CellId> take_locked();
  [[nodiscard]] SharedAdditions find(CellId cell) const;

  const VlodFile& file_;
  CellReader reader_;  // empty: the file's
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stopped_ = false;
  std::vector<CellId> wanted_;  // the most urgent last
  std::vector<CellId> under_way_;
  std::vector<CellLoad> ended_;
  std::map<CellId, SharedAdditions> additions_;  // of nodes that have children
};

// Holds the prepared cells of a walk within its memory limit.

class CellResidents {
 public:
  // `base_triangles` is the number of triangles of the base meshes of all objects; unless the file is packed, they need
  // no bytes for vertices.
  CellResidents(const VlodFile& file, std::size_t base_triangles);

  void add(CellId cell, std::shared_ptr<const CellMesh> mesh);
  // Returns the mesh of the cell, or null if it is not resident.
  [[nodiscard]] const std::shared_ptr<const CellMesh>& find(CellId cell) const;
  // Returns the bytes of all resident cells.
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
  // Returns the bytes of this cell, estimated if it has never been resident.
  [[nodiscard]] std::size_t bytes_of(CellId cell) const;
  // Evicts cells other than these and the root, the least recently wanted first, until at most this many bytes are
  // left.
  void shrink(std::span<const CellId> kept, std::size_t bytes);

 private:
  struct Resident {
    std::shared_ptr<const CellMesh> mesh;
    std::size_t wanted = 0;  // time of the last use, in calls of shrink()
  };

  const CellTree& tree_;
  std::size_t triangle_bytes_;  // includes its share of the vertices
  std::size_t base_triangles_ = 0, objects_ = 0;
  std::map<CellId, Resident> residents_;
  std::map<CellId, std::size_t> known_bytes_;  // of cells that are or were resident
  std::size_t bytes_ = 0, calls_ = 0;
};

// Predicts how the eye moves and which cells it may enter soon.

// Describes a cell that may be entered.
struct ExpectedCell {
  CellId leaf = no_id;
  double seconds = 0.0;  // earliest time until then
};

// Estimates the velocity as an exponential mean over 0.2 s. A step longer than a root cell is a jump and does not
// count.
class WalkMotion {
 public:
  explicit WalkMotion(double jump) : jump_(jump) {}

  void step(const glm::dvec3& eye, double seconds);
  [[nodiscard]] const glm::dvec3& velocity() const noexcept { return velocity_; }

 private:
  double jump_;
  bool is_first_ = true;
  glm::dvec3 eye_{0.0}, velocity_{0.0};
};

// Finds the cells that may be entered within `horizon` seconds, the soonest first, at most `most`, without the cell of
// the eye: the neighbours across its faces, and the cells in a cone of slope 1/4 around the direction of motion.
class CellForecast {
 public:
  explicit CellForecast(const CellTree& tree) : tree_(tree) {}
  // Returns the expected cells, valid until the next call.
  const std::vector<ExpectedCell>& expect(CellId leaf, const glm::dvec3& eye, const glm::dvec3& velocity,
                                          double horizon, std::size_t most);

 private:
  void add(CellId leaf, double seconds);

  const CellTree& tree_;
  CellId here_ = no_id;
  std::vector<CellId> neighbours_;  // of the cell here_
  std::vector<CellId> found_;       // scratch
  std::vector<ExpectedCell> expected_;
};

}  // namespace occlod
