// What is drawn for a node of a tree of cells, ready to be drawn: its triangles, in blocks for the frustum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cells/leaf_faces.h"
#include "cells/packed_faces.h"
#include "occlod/cell_walker.h"
#include "occlod/refiner.h"
#include "occlod/vlod_file.h"

namespace occlod {

// Immutable once it is made.
struct CellMesh {
  std::vector<Triangle> triangles;    // of all objects
  std::vector<TriangleBlock> blocks;  // of all objects
  struct Object {
    std::uint32_t first_triangle = 0, triangles = 0, first_block = 0, blocks = 0;
    // Its wedges, of a packed file; else there are none, and triangles are of the hierarchy's.
    struct Part {
      std::uint32_t first = 0, count = 0;
    };
    Part positions, normals, colors, coordinates, materials;
  };
  std::vector<glm::vec3> positions, normals;  // of all objects, in object space
  std::vector<glm::u8vec4> colors;            // of all objects, as what follows
  std::vector<glm::vec2> coordinates;
  std::vector<MaterialId> materials;
  std::vector<Object> objects;
  double error_px = 0.0;  // of a leaf as the file has it; of other nodes for all eyes in its box, see CellMeshMaker

  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof(*this) + triangles.capacity() * sizeof(Triangle) + blocks.capacity() * sizeof(TriangleBlock) +
           objects.capacity() * sizeof(Object) + (positions.capacity() + normals.capacity()) * sizeof(glm::vec3) +
           colors.capacity() * sizeof(glm::u8vec4) + coordinates.capacity() * sizeof(glm::vec2) +
           materials.capacity() * sizeof(MaterialId);
  }
};

// Reuses its memory; one thread each.
class CellMeshMaker {
 public:
  // Both outlive it.
  CellMeshMaker(const VlodFile& file, std::span<const RefineObject> objects);
  // Of a packed file, whose objects have no hierarchies; the cache outlives it. `max_bytes`: see PackedFaces.
  CellMeshMaker(const VlodFile& file, vlod::GeometryCache& cache, std::size_t max_bytes);

  // `path`: what the nodes from the root to this one add. A leaf is drawn as read_cell() gives it. Of another node all
  // faces are drawn that do not turn away from its box: those hidden in the leaves below are hidden by what these
  // have. Its error is that of all splits that it lacks, seen or not. O(size of the cut).
  [[nodiscard]] CellMesh make(CellId cell, std::span<const CellAdditions* const> path);
  // The error alone, of a node that is no leaf. Not of a packed file, which has it in its nodes.
  [[nodiscard]] double error_px(CellId cell, std::span<const CellAdditions* const> path);
  // That was read of geometry since the last call of this.
  [[nodiscard]] std::uint64_t take_bytes_read() noexcept { return packed_ ? packed_->take_bytes_read() : 0; }

 private:
  [[nodiscard]] CellView view_of(CellId cell, std::uint32_t object) const;
  [[nodiscard]] double error_of(std::uint32_t object, const CellView& view) const;
  void draw(CellId cell, std::uint32_t object, const CellView& view);
  void append(std::uint32_t object, CellMesh& mesh);

  const VlodFile& file_;
  std::vector<RefineObject> objects_;
  LeafFaces faces_;                          // of hierarchies
  std::optional<vlod::PackedFaces> packed_;  // or of a packed file
  PathCut cut_;                              // of the object at hand
  CellObjectMesh drawn_;                     // of it; wedges only of a packed file
};

}  // namespace occlod
