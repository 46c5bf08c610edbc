// What a walker wants to be loaded, and what has been: shared by the walker and its loaders.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
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

using SharedAdditions = std::shared_ptr<const CellAdditions>;

// A load that has ended.
struct CellLoad {
  CellId cell = no_id;
  std::shared_ptr<const CellMesh> mesh;                       // none where it failed
  std::vector<std::pair<CellId, SharedAdditions>> additions;  // that were read for it, of nodes with others below
  std::uint64_t bytes_read = 0;                               // of the file
  CellId failed = no_id;                                      // what could not be read: on the path to `cell`
  std::string problem;                                        // in one line
};

// Thread-safe. Locks are held for as long as it takes to look something up, never while anything is read or prepared.
class CellLoads {
 public:
  CellLoads(const VlodFile& file, CellReader reader) : file_(file), reader_(std::move(reader)) {}

  // For loaders. What is wanted most and nobody loads yet; take_or_wait() waits for it, and returns nothing when there
  // is nothing more to come.
  [[nodiscard]] std::optional<CellId> take();
  [[nodiscard]] std::optional<CellId> take_or_wait();
  // Reads what is not at hand of the path to the cell, and prepares it. Does not throw.
  [[nodiscard]] CellLoad load(CellId cell, CellMeshMaker& maker) const;
  void finish(CellLoad load);

  // For the walker. In place of what was wanted before, the most urgent first.
  void want(std::span<const CellId> cells);
  // What has ended since the last call. Clears `out`.
  void collect(std::vector<CellLoad>& out);
  [[nodiscard]] std::size_t addition_bytes() const;
  // Forgets what other nodes add than those of the path.
  void keep_additions(std::span<const CellId> path);
  void stop();

 private:
  [[nodiscard]] std::optional<CellId> take_locked();
  [[nodiscard]] SharedAdditions find(CellId cell) const;

  const VlodFile& file_;
  CellReader reader_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stopped_ = false;
  std::vector<CellId> wanted_;  // the most urgent last
  std::vector<CellId> under_way_;
  std::vector<CellLoad> ended_;
  std::map<CellId, SharedAdditions> additions_;  // of nodes with others below
};

// The prepared cells of a walk, within its memory.

class CellResidents {
 public:
  // `base_triangles`: of the base meshes of all objects, which have no bytes of their own for vertices unless the file
  // is packed.
  CellResidents(const VlodFile& file, std::size_t base_triangles);

  void add(CellId cell, std::shared_ptr<const CellMesh> mesh);
  // None if it is not there.
  [[nodiscard]] const std::shared_ptr<const CellMesh>& find(CellId cell) const;
  // Of all.
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
  // What this one takes, or takes about if it has never been there.
  [[nodiscard]] std::size_t bytes_of(CellId cell) const;
  // Drops others than these and the root, those first that have been wanted least lately, until there are no more bytes
  // than that.
  void shrink(std::span<const CellId> kept, std::size_t bytes);

 private:
  struct Resident {
    std::shared_ptr<const CellMesh> mesh;
    std::size_t wanted = 0;  // when: calls of shrink()
  };

  const CellTree& tree_;
  std::size_t triangle_bytes_;  // with its share of the vertices
  std::size_t base_triangles_ = 0, objects_ = 0;
  std::map<CellId, Resident> residents_;
  std::map<CellId, std::size_t> known_bytes_;  // of cells that are there or have been
  std::size_t bytes_ = 0, calls_ = 0;
};

// How the eye moves, and which cells it may enter soon.

// A cell that may be entered.
struct ExpectedCell {
  CellId leaf = no_id;
  double seconds = 0.0;  // until then, at the soonest
};

// Velocity as an exponential mean over 0.2 s. A step longer than a root cell is a jump, and tells nothing of it.
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

// The cells that may be entered within `horizon` seconds, the soonest first; that of the eye is not among them: the
// neighbours across its faces, and what lies in a cone of slope 1/4 around straight ahead. At most `most`.
class CellForecast {
 public:
  explicit CellForecast(const CellTree& tree) : tree_(tree) {}
  // Valid until the next call.
  const std::vector<ExpectedCell>& expect(CellId leaf, const glm::dvec3& eye, const glm::dvec3& velocity,
                                          double horizon, std::size_t most);

 private:
  void add(CellId leaf, double seconds);

  const CellTree& tree_;
  CellId here_ = no_id;
  std::vector<CellId> neighbours_;  // of here_
  std::vector<CellId> found_;       // scratch
  std::vector<ExpectedCell> expected_;
};

}  // namespace occlod
