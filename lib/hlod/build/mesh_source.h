// Where a store reads meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "occlod/hlod/hlod.h"

namespace occlod::hlod {

using MeshBytes = std::unique_ptr<std::byte[]>;

// A mesh where it is stored, which may take fewer bytes than in memory.
struct StoredMesh {
  std::uint64_t place = 0;
  std::size_t bytes = 0;
};

// Called by one thread at a time, but for bytes_of() and stored().
class MeshSource {
 public:
  MeshSource() = default;
  MeshSource(const MeshSource&) = delete;
  MeshSource& operator=(const MeshSource&) = delete;
  virtual ~MeshSource() = default;

  // In memory, of the mesh of node n and what aligns the next one; a multiple of mesh_alignment but for the last.
  [[nodiscard]] virtual std::size_t bytes_of(NodeId n) const noexcept = 0;
  // Of node n. Nodes of consecutive ids lie side by side where one ends at the place of the next.
  [[nodiscard]] virtual StoredMesh stored(NodeId n) const noexcept = 0;
  // What is stored of consecutive nodes from `first` on, which lie side by side, each into an array of stored() bytes.
  // Throws Error when it cannot be read.
  virtual void read(NodeId first, std::span<const std::span<std::byte>> meshes) = 0;
  // The mesh of node n, of bytes_of() bytes, from what was read of it. Throws Error when that is damaged.
  [[nodiscard]] virtual MeshBytes unpack(NodeId n, MeshBytes stored) = 0;
};

}  // namespace occlod::hlod
