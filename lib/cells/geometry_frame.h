// The geometry of some splits of a packed .vlod file: one frame of its section GEOM.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "occlod/core/ids.h"
#include "occlod/mesh/triangle_mesh.h"

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

inline constexpr std::uint32_t most_frame_bytes = 16U << 20U;  // decoded

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
// vertices that can be used. Meshes of pieces and their splits are there; raw_bytes <= most_frame_bytes.
[[nodiscard]] std::optional<GeometryFrame> decode_frame(std::span<const std::byte> bytes, std::uint32_t raw_bytes,
                                                        std::span<const PieceRow> pieces,
                                                        std::span<const MeshRow> meshes, std::string& problem);

// Whether all coordinates are finite.
[[nodiscard]] bool are_finite(std::span<const glm::vec3> vectors);

}  // namespace occlod::vlod
