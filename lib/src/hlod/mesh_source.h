// Where a store reads meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "occlod/hlod/hlod.h"

namespace occlod::hlod {

// Called by one thread at a time, but for bytes_of().
class MeshSource {
 public:
  MeshSource() = default;
  MeshSource(const MeshSource&) = delete;
  MeshSource& operator=(const MeshSource&) = delete;
  virtual ~MeshSource() = default;

  // Of the mesh of node n and what aligns the next one; a multiple of mesh_alignment but for the last.
  [[nodiscard]] virtual std::size_t bytes_of(NodeId n) const noexcept = 0;
  // The meshes of consecutive nodes from `first` on, which lie side by side, each into an array of bytes_of() bytes.
  // Throws Error when they cannot be read.
  virtual void read(NodeId first, std::span<const std::span<std::byte>> meshes) = 0;
  // Throws Error when what was read as the mesh of node n is damaged.
  virtual void check(NodeId n, std::span<const std::byte> mesh) const = 0;
};

}  // namespace occlod::hlod
