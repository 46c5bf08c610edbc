// Assembles the faces of a cut of a packed file, with their vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "cells/packed_geometry.h"
#include "occlod/cell_builder.h"
#include "occlod/hierarchy.h"
#include "occlod/vlod_file.h"

namespace occlod::vlod {

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

}  // namespace occlod::vlod
