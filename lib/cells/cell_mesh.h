// Holds what is drawn for a node of a tree of cells: its triangles, in blocks for frustum culling.
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

// Immutable after construction.
struct CellMesh {
  std::vector<Triangle> triangles;    // of all objects
  std::vector<TriangleBlock> blocks;  // of all objects
  struct Object {
    std::uint32_t first_triangle = 0, triangles = 0, first_block = 0, blocks = 0;
    // Wedges of the object, for a packed file; otherwise empty, and triangles refer to the hierarchy's wedges.
    struct Part {
      std::uint32_t first = 0, count = 0;
    };
    Part positions, normals, colors, coordinates, materials;
  };
  std::vector<glm::vec3> positions, normals;  // of all objects, in object space
  std::vector<glm::u8vec4> colors;            // of all objects, as are the following
  std::vector<glm::vec2> coordinates;
  std::vector<MaterialId> materials;
  std::vector<Object> objects;
  double error_px = 0.0;  // of a leaf as stored in the file; of other nodes for all eyes in its box, see CellMeshMaker

  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof(*this) + triangles.capacity() * sizeof(Triangle) + blocks.capacity() * sizeof(TriangleBlock) +
           objects.capacity() * sizeof(Object) + (positions.capacity() + normals.capacity()) * sizeof(glm::vec3) +
           colors.capacity() * sizeof(glm::u8vec4) + coordinates.capacity() * sizeof(glm::vec2) +
           materials.capacity() * sizeof(MaterialId);
  }
};

// Makes cell meshes, reusing its memory; each thread needs its own.
class CellMeshMaker {
 public:
  // Both arguments must outlive this object.
  CellMeshMaker(const VlodFile& file, std::span<const RefineObject> objects);
  // For a packed file, whose objects have no hierarchies. The cache must outlive this object. `max_bytes`: see
  // PackedFaces.
  CellMeshMaker(const VlodFile& file, vlod::GeometryCache& cache, std::size_t max_bytes);

  // Makes the mesh of a node. `path` holds what the nodes from the root to this one add. A leaf is drawn as read_cell()
  // returns it. Of another node all faces are drawn that do not face away from its box, because faces hidden in the
  // leaves below are hidden by geometry of those leaves. Its error is that of all splits that it lacks, visible or not.
  // O(size of the cut).
  [[nodiscard]] CellMesh make(CellId cell, std::span<const CellAdditions* const> path);
  // Returns only the error, of a node that is no leaf. Not for packed files, which store the errors of their nodes.
  [[nodiscard]] double error_px(CellId cell, std::span<const CellAdditions* const> path);
  // Returns the bytes of geometry read since the last call.
  [[nodiscard]] std::uint64_t take_bytes_read() noexcept { return packed_ ? packed_->take_bytes_read() : 0; }

 private:
  [[nodiscard]] CellView view_of(CellId cell, std::uint32_t object) const;
  [[nodiscard]] double error_of(std::uint32_t object, const CellView& view) const;
  void draw(CellId cell, std::uint32_t object, const CellView& view);
  void append(std::uint32_t object, CellMesh& mesh);

  const VlodFile& file_;
  std::vector<RefineObject> objects_;
  LeafFaces faces_;                          // used with hierarchies
  std::optional<vlod::PackedFaces> packed_;  // used with a packed file
  PathCut cut_;                              // of the current object
  CellObjectMesh drawn_;                     // of the current object; wedges only for a packed file
};

}  // namespace occlod
