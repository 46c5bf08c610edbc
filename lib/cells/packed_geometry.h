// The hierarchies of a packed .vlod file, as far as its cells use them: base meshes in memory, the rest frame by frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/platform.h"
#include "mesh/material_sections.h"
#include "mesh/section_file.h"
#include "occlod/mesh/triangle_mesh.h"
#include "occlod/viewcells/vlod_file.h"
#include "cells/geometry_frame.h"

namespace occlod::vlod {

inline constexpr std::string_view meshes_name = "MESH", base_positions_name = "BPOS", base_normals_name = "BNOR",
                                  base_colors_name = "BCOL", base_faces_name = "BFAC", frames_name = "FRAM",
                                  pieces_name = "PIEC", geometry_name = "GEOM", permutation_name = "PERM";
// Of version 3. Of the vertices of base meshes with seams how many wedges they have beyond their first, and of their
// faces which wedge of its vertex each corner has; of each mesh how much of what there is of materials is its own.
inline constexpr std::string_view base_coordinates_name = "BUVS", base_materials_name = "BMAT",
                                  base_wedges_name = "BWED", base_corners_name = "BCOR", looks_name = "LOOK";

// Of one mesh: how many of the materials and textures of the file (io/material_sections.h), one mesh after the other.
// Materials count the textures of their own mesh.
struct LookRow {
  std::uint32_t materials = 0;
  std::uint32_t textures = 0;
  std::uint32_t texture_origin = 0;  // TextureOrigin
  std::uint32_t reserved = 0;
};
static_assert(sizeof(LookRow) == 16);

// A frame of section GEOM.
struct FrameRow {
  std::uint64_t offset = 0;    // from the start of the section
  std::uint64_t checksum = 0;  // XXH3-64
  std::uint32_t bytes = 0;
  std::uint32_t raw_bytes = 0;    // decoded; the same when it is stored as it is
  std::uint32_t first_piece = 0;  // of its pieces
  std::uint32_t pieces = 0;       // >= 1
};
static_assert(sizeof(FrameRow) == 32);

// For each object its mesh: the objects with one hierarchy have one, in the order of the first of each.
[[nodiscard]] std::vector<std::uint32_t> meshes_of(std::span<const VlodObject> objects);

// Immutable; any number of threads may use one.
class PackedGeometry {
 public:
  // `file`: the same, for read(); outlives this. Throws Error when tables and base meshes do not fit together.
  PackedGeometry(sections::SectionReader& reader, std::span<const VlodObject> objects, const InputFile& file,
                 std::string subject);

  [[nodiscard]] std::uint32_t mesh_of(std::uint32_t object) const noexcept { return mesh_of_[object]; }
  [[nodiscard]] const MeshRow& mesh(std::uint32_t mesh) const noexcept { return meshes_[mesh]; }
  [[nodiscard]] std::span<const MeshRow> meshes() const noexcept { return meshes_; }

  // Vertices, their wedges and triangles to which no split is applied; attributes only where the mesh has any.
  struct Base {
    std::span<const glm::vec3> positions, normals;
    std::span<const glm::u8vec4> colors;
    std::span<const glm::vec2> coordinates;
    std::span<const MaterialId> materials;
    std::span<const std::uint32_t> first_wedges;  // by vertex, and one more; empty: each has one
    std::span<const Triangle> faces;
    std::span<const Triangle> corners;  // of faces: which wedges of their vertices; empty: the first

    [[nodiscard]] std::uint32_t first_wedge(VertexId v) const noexcept {
      return first_wedges.empty() ? v : first_wedges[v];
    }
    [[nodiscard]] std::uint32_t extra_count(VertexId v) const noexcept {
      return first_wedges.empty() ? 0 : first_wedges[v + std::size_t{1}] - first_wedges[v] - 1;
    }
  };
  [[nodiscard]] Base base(std::uint32_t mesh) const noexcept;

  [[nodiscard]] SurfaceMaterials materials(std::uint32_t mesh) const noexcept;

  // Some splits of one mesh, in a frame.
  struct Piece {
    PieceRow row;
    std::uint32_t frame = 0;
    std::uint32_t number = 0;  // in the frame
    std::uint32_t place = 0;   // of its first split in the frame
  };
  // That which has this split; split < mesh(mesh).splits.
  [[nodiscard]] const Piece& piece_of(std::uint32_t mesh, SplitId split) const noexcept;
  [[nodiscard]] std::span<const FrameRow> frames() const noexcept { return frames_; }
  // Frames `first` to first + count - 1, which are read at once. Throws Error when they cannot be, or one is damaged.
  [[nodiscard]] std::vector<std::shared_ptr<const GeometryFrame>> read(std::uint32_t first, std::uint32_t count) const;

  // In memory.
  [[nodiscard]] std::size_t bytes() const noexcept;
  // Where messages say that something is wrong.
  [[nodiscard]] const std::string& subject() const noexcept { return subject_; }

 private:
  void take_meshes(sections::SectionReader& reader, std::span<const VlodObject> objects);
  void take_base(sections::SectionReader& reader);
  void check_base(sections::SectionReader& reader) const;
  // Whether all of these materials are of the mesh.
  [[nodiscard]] bool are_there(std::uint32_t mesh, std::span<const MaterialId> of_wedges) const;
  void take_materials(sections::SectionReader& reader);
  void take_frames(sections::SectionReader& reader);
  [[nodiscard]] std::shared_ptr<const GeometryFrame> decode(std::uint32_t frame,
                                                            std::span<const std::byte> bytes) const;
  [[nodiscard]] std::span<const PieceRow> pieces_of(const FrameRow& frame) const {
    return std::span(rows_).subspan(frame.first_piece, frame.pieces);
  }

  const InputFile& file_;
  std::string subject_;
  std::uint64_t data_ = 0;  // where section GEOM begins
  std::vector<std::uint32_t> mesh_of_;
  std::vector<MeshRow> meshes_;
  struct First {
    // Of the base mesh, among those of all. `wedges`: of first_wedges_.
    std::size_t vertex = 0, wedges = 0, normal = 0, color = 0, coordinate = 0, material = 0, face = 0, corner = 0;
  };
  std::vector<First> first_;  // one more than meshes
  std::vector<glm::vec3> positions_, normals_;
  std::vector<glm::u8vec4> colors_;
  std::vector<glm::vec2> coordinates_;
  std::vector<MaterialId> wedge_materials_;
  std::vector<std::uint32_t> first_wedges_;
  std::vector<Triangle> faces_, corners_;
  std::vector<sections::Materials> materials_;  // by mesh; none where no mesh has any
  std::vector<FrameRow> frames_;
  std::vector<PieceRow> rows_;              // frame by frame
  std::vector<std::vector<Piece>> pieces_;  // by mesh, ascending
};

}  // namespace occlod::vlod
