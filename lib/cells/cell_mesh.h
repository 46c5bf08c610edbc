// Holds what is drawn for a node of a tree of cells: its triangles, in blocks for frustum culling.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "cells/leaf_faces.h"
#include "cells/packed_geometry.h"
#include "occlod/cell_builder.h"
#include "occlod/cell_walker.h"
#include "occlod/hierarchy.h"
#include "occlod/refiner.h"
#include "occlod/vlod_file.h"
#include "splits/star.h"

namespace occlod {

namespace vlod {

// Assembles the faces of a cut of a packed file, with their vertices.
// Reuses its memory; each thread needs its own.
class PackedFaces {
 public:
  // `max_bytes` limits the memory that the geometry of one object's cut may use while it is assembled. The cache must
  // outlive this object.
  PackedFaces(GeometryCache& cache, std::size_t max_bytes) : cache_(cache), max_bytes_(max_bytes) {}

  // Returns what is drawn of an object: the active faces that are neither hidden nor face away, as defined by
  // LeafFaces, and the vertices that they use. `applied` is ascending, in the numbers of the file within the mesh.
  // `hidden` may have any order; entries of splits that are not applied are ignored. `view` is null where both sides
  // are drawn. Clears `out` first. Throws Error that names `place` when the applied splits are inconsistent, and for
  // frames that cannot be read. O(size of the cut).
  void draw(std::uint32_t object, std::span<const SplitId> applied, std::span<const FaceRef> hidden,
            const CellView* view, const std::string& place, CellObjectMesh& out);

  // Returns the bytes that draw() has read from the file since the last call.
  [[nodiscard]] std::uint64_t take_bytes_read() noexcept { return std::exchange(bytes_read_, 0); }

 private:
  // Holds applied splits with consecutive numbers.
  struct Run {
    SplitId first = 0, end = 0;
    std::uint32_t rank = 0;  // rank of the first: number of applied splits before it
  };
  struct Vertex {
    const GeometryFrame* frame = nullptr;
    std::uint32_t place = 0;  // index in the frame
    WedgePlace first;         // of its wedges
  };

  void take_cut(std::uint32_t mesh, std::span<const SplitId> applied, const std::string& place);
  void take_frames(std::span<const SplitId> applied, const std::string& place);
  void remove_faces(std::span<const SplitId> applied, std::span<const FaceRef> hidden, const std::string& place);
  void remove(const FaceRef& face, const std::string& place);
  [[nodiscard]] std::uint32_t rank_of(SplitId s) const noexcept;  // no_id: not applied
  [[nodiscard]] SplitStar star(std::uint32_t rank, SplitId s) const noexcept;
  // base vertices, then by rank; no_id: not there
  [[nodiscard]] std::uint32_t place_of(VertexId vertex) const noexcept;
  [[nodiscard]] const glm::vec3& position(std::uint32_t place) const noexcept;
  // Appends a face; `corners` tells which wedges of its vertices it uses.
  void put(const Triangle& t, const Triangle& corners, const CellView* view, const std::string& place,
           CellObjectMesh& out);
  [[nodiscard]] std::uint32_t put_wedge(std::uint32_t place, std::uint32_t wedge, CellObjectMesh& out);
  [[nodiscard]] std::uint32_t extra_count(std::uint32_t place) const noexcept;
  [[noreturn]] void refuse(const std::string& place, const std::string& problem) const;

  GeometryCache& cache_;
  std::size_t max_bytes_;
  std::uint64_t bytes_read_ = 0;
  // State of the current object.
  std::uint32_t mesh_ = 0;
  PackedGeometry::Base base_;
  std::vector<const PackedGeometry::Piece*> pieces_;  // containing the applied splits
  std::vector<std::uint32_t> numbers_;                // numbers of their frames
  GeometryCache::Frames frames_;
  std::vector<Run> runs_;
  std::vector<Vertex> vertices_;           // by rank
  std::vector<std::uint32_t> first_face_;  // by rank, then the total; base faces come first
  std::vector<bool> removed_;              // or hidden; per face
  // Index in `out` of the first wedge of each vertex, or no_id; and of other wedges by vertex and wedge.
  std::vector<std::uint32_t> out_of_;
  std::unordered_map<std::uint64_t, std::uint32_t> out_of_others_;
};

}  // namespace vlod

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

struct PlacedTriangle {
  glm::vec3 place{0.0F};  // sum of its corners
  Triangle triangle{0};
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
  void append_blocks(std::span<const glm::vec3> positions, CellMesh& mesh);

  const VlodFile& file_;
  std::vector<RefineObject> objects_;
  LeafFaces faces_;                          // used with hierarchies
  std::optional<vlod::PackedFaces> packed_;  // used with a packed file
  PathCut cut_;                              // of the current object
  CellObjectMesh drawn_;                     // of the current object; wedges only for a packed file
  std::vector<PlacedTriangle> placed_;       // those of drawn_
};

}  // namespace occlod
