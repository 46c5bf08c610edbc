// The geometry of some splits of a packed .vlod file: one frame of its section GEOM.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/platform.h"
#include "mesh/section_file.h"
#include "occlod/base.h"
#include "occlod/mesh.h"
#include "occlod/vlod_file.h"

namespace occlod::vlod {

// A hierarchy as a packed file has it: its base mesh, and those splits that some cell applies. They are numbered anew,
// and so are their vertices: vertex base_vertices + s for split s.
struct MeshRow {
  std::uint32_t base_vertices = 0;
  std::uint32_t base_faces = 0;
  std::uint32_t splits = 0;
  std::uint32_t attributes = 0;  // of its wedges: has_normals | ...
};
static_assert(sizeof(MeshRow) == 16);
// has_seams: some vertices have more than one wedge. The others are as MeshRow says in files of version 2, too.
inline constexpr std::uint32_t has_normals = 1, has_colors = 2, has_coordinates = 4, has_materials = 8, has_seams = 16;
inline constexpr std::uint32_t all_attributes = 31;

// Splits `first` to first + count - 1 of a mesh, in a frame.
struct PieceRow {
  std::uint32_t mesh = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;  // >= 1
};
static_assert(sizeof(PieceRow) == 12);

inline constexpr std::uint32_t max_frame_bytes = 16U << 20U;  // decoded

// Where a wedge is in those arrays of a frame that its mesh has.
struct WedgePlace {
  std::uint32_t normal = 0, color = 0, coordinate = 0, material = 0;

  [[nodiscard]] WedgePlace after(std::uint32_t wedges) const noexcept {
    return {normal + wedges, color + wedges, coordinate + wedges, material + wedges};
  }
};

// A frame in memory. Of every piece the splits one after the other, and in the same order their vertices; of each
// vertex its wedges one after the other. Where no mesh has seams, a wedge is a vertex, and extra_wedges and the arrays
// of corners are empty.
struct GeometryFrame {
  std::vector<std::uint32_t> words;  // records, see SplitStar
  std::vector<std::uint32_t> stars;  // where the record of each split begins
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;      // of the wedges of meshes that have any
  std::vector<glm::u8vec4> colors;     // likewise
  std::vector<glm::vec2> coordinates;  // likewise
  std::vector<MaterialId> materials;   // likewise
  std::vector<std::uint32_t> corners;  // of the faces that a split inserts: which wedge of its vertex each corner has
  std::vector<std::uint32_t> extra_wedges;   // by split, and one more: how many the vertices before it have
  std::vector<std::uint32_t> corner_starts;  // likewise: where its corners begin; none where all are first wedges

  std::vector<WedgePlace> pieces;  // the first wedge of each piece; set when it is decoded

  // The first wedge of the vertex of split `place` of the frame, which is in this piece, whose first split is `first`.
  [[nodiscard]] WedgePlace first_wedge(std::uint32_t place, std::uint32_t piece, std::uint32_t first) const noexcept {
    return pieces[piece].after(place - first + extra_before(place) - extra_before(first));
  }
  [[nodiscard]] std::uint32_t extra_before(std::uint32_t place) const noexcept {
    return extra_wedges.empty() ? 0 : extra_wedges[place];
  }
  // How many wedges the vertex of a split has beyond its first.
  [[nodiscard]] std::uint32_t extra_count(std::uint32_t place) const noexcept {
    return extra_wedges.empty() ? 0 : extra_wedges[place + 1] - extra_wedges[place];
  }
  // Which wedges of their vertices a face that a split inserts has.
  [[nodiscard]] Triangle corners_of(std::uint32_t place, std::uint32_t slot) const noexcept {
    if (corner_starts.empty() || corner_starts[place] == corner_starts[place + 1]) return Triangle(0);
    const std::uint32_t* const at = corners.data() + corner_starts[place] + 3 * std::size_t{slot};
    return {at[0], at[1], at[2]};
  }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof(*this) +
           (words.size() + stars.size() + colors.size() + corners.size() + extra_wedges.size() + corner_starts.size()) *
               sizeof(std::uint32_t) +
           (positions.size() + normals.size()) * sizeof(glm::vec3) + coordinates.size() * sizeof(glm::vec2) +
           materials.size() * sizeof(MaterialId) + pieces.size() * sizeof(WedgePlace);
  }
};

// Elements as they are before they are compressed: how many bytes, for is_plausible().
struct EncodedFrame {
  std::vector<std::byte> bytes;
  std::uint32_t raw_bytes = 0;  // the same number: stored as it is
};
// `level`: of zstd, in [1, 19]; 0: not compressed. The same bytes on every run.
[[nodiscard]] EncodedFrame encode_frame(const GeometryFrame& frame, std::span<const PieceRow> pieces,
                                        std::span<const MeshRow> meshes, int level);
// Nothing, and what is wrong in `problem`, when the bytes do not hold the splits of these pieces, with records and
// vertices that can be used. Meshes of pieces and their splits are there; raw_bytes <= max_frame_bytes.
[[nodiscard]] std::optional<GeometryFrame> decode_frame(std::span<const std::byte> bytes, std::uint32_t raw_bytes,
                                                        std::span<const PieceRow> pieces,
                                                        std::span<const MeshRow> meshes, std::string& problem);

// Whether all coordinates are finite.
[[nodiscard]] bool are_finite(std::span<const glm::vec3> vectors);

// The hierarchies of a packed .vlod file, as far as its cells use them: base meshes in memory, the rest frame by frame.

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

// Frames of a packed file that are in memory.

// Thread-safe. Its lock is not held while anything is read.
class GeometryCache {
 public:
  using Frames = std::vector<std::shared_ptr<const GeometryFrame>>;

  // Keeps nothing until limit() says how much. `before_read`: called with the bytes that are read next, on the thread
  // that reads; may be empty. `geometry` outlives it.
  GeometryCache(const PackedGeometry& geometry, std::function<void(std::uint64_t bytes)> before_read)
      : geometry_(geometry), before_read_(std::move(before_read)) {}

  [[nodiscard]] const PackedGeometry& geometry() const noexcept { return geometry_; }
  // In the order of the frames, which ascend. Reads those that are not there, neighbours at once, and adds what was
  // read to `bytes_read`. Throws Error as PackedGeometry::read() does. Clears `out`.
  void get(std::span<const std::uint32_t> frames, Frames& out, std::uint64_t& bytes_read);
  // Keeps no more bytes than that from now on; drops what has not been asked for longest.
  void limit(std::size_t bytes);

  [[nodiscard]] std::size_t bytes() const;

 private:
  void find(std::span<const std::uint32_t> frames, Frames& out);
  void read(std::uint32_t first, std::span<std::shared_ptr<const GeometryFrame>> out, std::uint64_t& bytes_read);
  void shrink();

  const PackedGeometry& geometry_;
  std::function<void(std::uint64_t bytes)> before_read_;
  mutable std::mutex mutex_;
  struct Entry {
    std::shared_ptr<const GeometryFrame> frame;
    std::uint64_t asked = 0;  // when: calls of get()
  };
  std::map<std::uint32_t, Entry> entries_;
  std::size_t bytes_ = 0, limit_ = 0;
  std::uint64_t calls_ = 0;
};

}  // namespace occlod::vlod
