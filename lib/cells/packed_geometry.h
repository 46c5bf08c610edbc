// Encodes the geometry of some splits of a packed .vlod file: one frame of its section GEOM.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
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

// Describes a hierarchy in a packed file: its base mesh, and those splits that some cell applies. Splits and vertices
// are renumbered: split s has vertex base_vertices + s.
struct MeshRow {
  std::uint32_t base_vertices = 0;
  std::uint32_t base_faces = 0;
  std::uint32_t splits = 0;
  std::uint32_t attributes = 0;  // of its wedges: has_normals | ...
};
static_assert(sizeof(MeshRow) == 16);
// With has_seams, some vertices have more than one wedge. The other flags have the same meaning in files of version 2.
inline constexpr std::uint32_t has_normals = 1, has_colors = 2, has_coordinates = 4, has_materials = 8, has_seams = 16;
inline constexpr std::uint32_t all_attributes = 31;

// Describes splits `first` to first + count - 1 of a mesh, in a frame.
struct PieceRow {
  std::uint32_t mesh = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;  // >= 1
};
static_assert(sizeof(PieceRow) == 12);

inline constexpr std::uint32_t max_frame_bytes = 16U << 20U;  // decoded

// Locates a wedge in those arrays of a frame that its mesh has.
struct WedgePlace {
  std::uint32_t normal = 0, color = 0, coordinate = 0, material = 0;

  [[nodiscard]] WedgePlace after(std::uint32_t wedges) const noexcept {
    return {normal + wedges, color + wedges, coordinate + wedges, material + wedges};
  }
};

// Holds a decoded frame: the splits of every piece one after the other, in the same order their vertices, and the
// wedges of each vertex one after the other. Where no mesh has seams, a wedge is a vertex, and extra_wedges and the
// arrays of corners are empty.
struct GeometryFrame {
  std::vector<std::uint32_t> words;  // records, see SplitStar
  std::vector<std::uint32_t> stars;  // start of the record of each split
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;      // of the wedges of meshes that have normals
  std::vector<glm::u8vec4> colors;     // of the wedges of meshes that have colours
  std::vector<glm::vec2> coordinates;  // of the wedges of meshes that have them
  std::vector<MaterialId> materials;   // of the wedges of meshes that have materials
  std::vector<std::uint32_t> corners;  // of inserted faces: which wedge of its vertex each corner uses
  // per split, then the total: number of extra wedges of the vertices before it
  std::vector<std::uint32_t> extra_wedges;
  // per split, then the total: start of its corners; empty range where all are first wedges
  std::vector<std::uint32_t> corner_starts;

  std::vector<WedgePlace> pieces;  // the first wedge of each piece; set when decoded

  // Returns the first wedge of the vertex of split `place` of the frame, which is in this piece, whose first split is
  // `first`.
  [[nodiscard]] WedgePlace first_wedge(std::uint32_t place, std::uint32_t piece, std::uint32_t first) const noexcept {
    return pieces[piece].after(place - first + extra_before(place) - extra_before(first));
  }
  [[nodiscard]] std::uint32_t extra_before(std::uint32_t place) const noexcept {
    return extra_wedges.empty() ? 0 : extra_wedges[place];
  }
  // Returns how many wedges the vertex of a split has beyond its first.
  [[nodiscard]] std::uint32_t extra_count(std::uint32_t place) const noexcept {
    return extra_wedges.empty() ? 0 : extra_wedges[place + 1] - extra_wedges[place];
  }
  // Returns which wedges of their vertices an inserted face of a split uses.
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

// Holds an encoded frame and its size before compression.
struct EncodedFrame {
  std::vector<std::byte> bytes;
  std::uint32_t raw_bytes = 0;  // equal to the number of bytes: stored uncompressed
};
// The level of zstd at which pack_cells() compresses: the highest, 19, saves 4 % more
// (docs/benchmarks/view_cells.md).
inline constexpr int pack_level = 12;
// Packs at another level, in [0, 19]; 0 does not compress the geometry.
void pack_cells(const VlodFile& file, std::span<const RefineObject> objects, const std::filesystem::path& path,
                const std::function<bool(double)>& progress, int level);

// Encodes a frame. `level` is the level of zstd, in [1, 19]; 0: not compressed. The bytes are the same on every run.
[[nodiscard]] EncodedFrame encode_frame(const GeometryFrame& frame, std::span<const PieceRow> pieces,
                                        std::span<const MeshRow> meshes, int level);
// Decodes a frame. Returns nothing, and describes the problem in `problem`, when the bytes do not contain the splits of
// these pieces with valid records and vertices. The meshes of pieces and their splits must exist; raw_bytes <=
// max_frame_bytes.
[[nodiscard]] std::optional<GeometryFrame> decode_frame(std::span<const std::byte> bytes, std::uint32_t raw_bytes,
                                                        std::span<const PieceRow> pieces,
                                                        std::span<const MeshRow> meshes, std::string& problem);

// Returns whether all coordinates are finite.
[[nodiscard]] bool are_finite(std::span<const glm::vec3> vectors);

// Reads the hierarchies of a packed .vlod file, as far as its cells use them: base meshes in memory, the rest frame by
// frame.

inline constexpr std::string_view meshes_name = "MESH", base_positions_name = "BPOS", base_normals_name = "BNOR",
                                  base_colors_name = "BCOL", base_faces_name = "BFAC", frames_name = "FRAM",
                                  pieces_name = "PIEC", geometry_name = "GEOM", permutation_name = "PERM";
// Sections of version 3. For base meshes with seams they hold how many wedges vertices have beyond their first, and
// which wedge of its vertex each corner of a face uses; for each mesh, which part of the file's materials is its own.
inline constexpr std::string_view base_coordinates_name = "BUVS", base_materials_name = "BMAT",
                                  base_wedges_name = "BWED", base_corners_name = "BCOR", looks_name = "LOOK";

// Counts, for one mesh, its materials and textures among those of the file (mesh/materials.h), stored one mesh after
// the other. Materials refer to textures of their own mesh.
struct LookRow {
  std::uint32_t materials = 0;
  std::uint32_t textures = 0;
  std::uint32_t texture_origin = 0;  // TextureOrigin
  std::uint32_t reserved = 0;
};
static_assert(sizeof(LookRow) == 16);

// Describes a frame of section GEOM.
struct FrameRow {
  std::uint64_t offset = 0;    // from the start of the section
  std::uint64_t checksum = 0;  // XXH3-64
  std::uint32_t bytes = 0;
  std::uint32_t raw_bytes = 0;    // decoded size; equal to the stored size when uncompressed
  std::uint32_t first_piece = 0;  // index of its first piece
  std::uint32_t pieces = 0;       // >= 1
};
static_assert(sizeof(FrameRow) == 32);

// Returns the mesh of each object: objects with one hierarchy share one, in the order of first use.
[[nodiscard]] std::vector<std::uint32_t> meshes_of(std::span<const StoredObject> objects);

// Immutable and thread-safe.
class PackedGeometry {
 public:
  // `file` is the same file, for read(); it must outlive this object. Throws Error when tables and base meshes are
  // inconsistent.
  PackedGeometry(sections::SectionReader& reader, std::span<const StoredObject> objects, const InputFile& file,
                 std::string subject);

  [[nodiscard]] std::uint32_t mesh_of(std::uint32_t object) const noexcept { return mesh_of_[object]; }
  [[nodiscard]] const MeshRow& mesh(std::uint32_t mesh) const noexcept { return meshes_[mesh]; }
  [[nodiscard]] std::span<const MeshRow> meshes() const noexcept { return meshes_; }

  // Holds vertices, their wedges and triangles before any split is applied; attributes only where the mesh has them.
  struct Base {
    std::span<const glm::vec3> positions, normals;
    std::span<const glm::u8vec4> colors;
    std::span<const glm::vec2> coordinates;
    std::span<const MaterialId> materials;
    std::span<const std::uint32_t> first_wedges;  // by vertex, then the total; empty: one wedge per vertex
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

  // Describes some splits of one mesh in a frame.
  struct Piece {
    PieceRow row;
    std::uint32_t frame = 0;
    std::uint32_t number = 0;  // of the frame
    std::uint32_t place = 0;   // index of its first split in the frame
  };
  // Returns the piece that contains this split; split < mesh(mesh).splits.
  [[nodiscard]] const Piece& piece_of(std::uint32_t mesh, SplitId split) const noexcept;
  [[nodiscard]] std::span<const FrameRow> frames() const noexcept { return frames_; }
  // Reads frames `first` to first + count - 1 at once. Throws Error when they cannot be read or one is damaged.
  [[nodiscard]] std::vector<std::shared_ptr<const GeometryFrame>> read(std::uint32_t first, std::uint32_t count) const;

  // Returns the bytes in memory.
  [[nodiscard]] std::size_t bytes() const noexcept;
  // Returns the name that error messages use.
  [[nodiscard]] const std::string& subject() const noexcept { return subject_; }

 private:
  void take_meshes(sections::SectionReader& reader, std::span<const StoredObject> objects);
  void take_base(sections::SectionReader& reader);
  void check_base(sections::SectionReader& reader) const;
  // Returns whether all of these materials belong to the mesh.
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
  std::uint64_t data_ = 0;  // start of section GEOM
  std::vector<std::uint32_t> mesh_of_;
  std::vector<MeshRow> meshes_;
  struct First {
    // Indices of the first elements of a base mesh in the arrays of all. `wedges` indexes first_wedges_.
    std::size_t vertex = 0, wedges = 0, normal = 0, color = 0, coordinate = 0, material = 0, face = 0, corner = 0;
  };
  std::vector<First> first_;  // one more than meshes
  std::vector<glm::vec3> positions_, normals_;
  std::vector<glm::u8vec4> colors_;
  std::vector<glm::vec2> coordinates_;
  std::vector<MaterialId> wedge_materials_;
  std::vector<std::uint32_t> first_wedges_;
  std::vector<Triangle> faces_, corners_;
  std::vector<sections::Materials> materials_;  // per mesh; empty where no mesh has any
  std::vector<FrameRow> frames_;
  std::vector<PieceRow> rows_;              // frame by frame
  std::vector<std::vector<Piece>> pieces_;  // per mesh, ascending
};

// Caches frames of a packed file.

// Thread-safe. Does not hold its lock while reading.
class GeometryCache {
 public:
  using Frames = std::vector<std::shared_ptr<const GeometryFrame>>;

  // Keeps nothing until limit() sets how much. `geometry` must outlive this object.
  explicit GeometryCache(const PackedGeometry& geometry) : geometry_(geometry) {}

  // Before another thread uses the cache: is called with the number of bytes about to be read, on the thread that
  // reads; may be empty.
  void set_before_read(std::function<void(std::uint64_t bytes)> before_read) { before_read_ = std::move(before_read); }

  [[nodiscard]] const PackedGeometry& geometry() const noexcept { return geometry_; }
  // Returns frames in the order given, which must be ascending. Reads the missing ones, neighbours at once, and adds
  // the bytes read to `bytes_read`. Throws Error as PackedGeometry::read() does. Clears `out` first.
  void get(std::span<const std::uint32_t> frames, Frames& out, std::uint64_t& bytes_read);
  // Sets the maximum of bytes to keep; evicts the least recently used frames.
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
    std::uint64_t asked = 0;  // time of last use, in calls of get()
  };
  std::map<std::uint32_t, Entry> entries_;
  std::size_t bytes_ = 0, limit_ = 0;
  std::uint64_t calls_ = 0;
};

}  // namespace occlod::vlod
