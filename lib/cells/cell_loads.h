// What a walker wants to be loaded, and what has been: shared by the walker and its loaders.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "occlod/viewcells/cell_walker.h"
#include "cells/cell_mesh.h"

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

}  // namespace occlod
