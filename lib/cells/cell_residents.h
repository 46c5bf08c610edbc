// The prepared cells of a walk, within its memory.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "cells/cell_mesh.h"

namespace occlod {

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

}  // namespace occlod
