// The geometry of some splits of a packed .vlod file: one frame of its section GEOM.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "occlod/core/ids.h"

namespace occlod::vlod {

// A hierarchy as a packed file has it: its base mesh, and those splits that some cell applies. They are numbered anew,
// and so are their vertices: vertex base_vertices + s for split s.
struct MeshRow {
  std::uint32_t base_vertices = 0;
  std::uint32_t base_faces = 0;
  std::uint32_t splits = 0;
  std::uint32_t attributes = 0;  // of its vertices, has_normals | has_colors
};
static_assert(sizeof(MeshRow) == 16);
inline constexpr std::uint32_t has_normals = 1, has_colors = 2;

// Splits `first` to first + count - 1 of a mesh, in a frame.
struct PieceRow {
  std::uint32_t mesh = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;  // >= 1
};
static_assert(sizeof(PieceRow) == 12);

inline constexpr std::uint32_t most_frame_bytes = 16U << 20U;  // decoded

// A frame in memory. Of every piece the splits one after the other, and in the same order their vertices.
struct GeometryFrame {
  std::vector<std::uint32_t> words;  // records, see SplitStar
  std::vector<std::uint32_t> stars;  // where the record of each split begins
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;   // of the vertices of meshes that have any
  std::vector<glm::u8vec4> colors;  // likewise

  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof(*this) + (words.size() + stars.size() + colors.size()) * sizeof(std::uint32_t) +
           (positions.size() + normals.size()) * sizeof(glm::vec3);
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
