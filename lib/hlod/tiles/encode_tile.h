// What an accessor reads: elements of one size, in little-endian bytes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "base/file_input.h"
#include "hlod/tiles/tile_mesh.h"
#include "mesh/glb.h"
#include "occlod/tiles.h"

namespace occlod::tiles {

class ByteStream {
 public:
  ByteStream(std::size_t stride, std::size_t count) : stride_(stride), count_(count) { bytes_.reserve(stride * count); }

  // `count` times `stride` bytes in all.
  template <class... Numbers>
  void add(Numbers... values) {
    (add_one(values), ...);
  }
  [[nodiscard]] std::size_t stride() const noexcept { return stride_; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  template <class Number>
  void add_one(Number value) {
    auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
    bytes_.append(bytes.data(), bytes.size());
  }

  std::size_t stride_;
  std::size_t count_;
  std::string bytes_;
};

// EXT_meshopt_compression, by meshoptimizer where the library is built with it.

// Whether the build can. Where not, nothing else here may be called.
[[nodiscard]] bool has_meshopt() noexcept;

// Orders triangles for vertex caches and wedges by first use, which the codecs make use of.
void order_for_codec(GlbPrimitive& primitive);

// Mode ATTRIBUTES, version 0, without a filter.
[[nodiscard]] std::string encode_vertices(const ByteStream& stream);

// Mode TRIANGLES, version 1. Decoding may rotate triangles.
[[nodiscard]] std::string encode_triangles(std::span<const std::uint32_t> indices, std::size_t vertices);

// What the positions of a tile count from.

// A place from which all positions are exact as floats, for each coordinate: 0 where the box reaches to within half of
// its extent of it, else the middle of the box. Then differences are multiples of the last place of the smallest
// coordinate, and no larger than that coordinate.
[[nodiscard]] glm::dvec3 near_origin(std::span<const glm::vec3> positions);

// The points whose coordinates are multiples of a power of two, near some positions. So two lattices of one step have
// the same points: tiles of about the same size round a vertex that they share to the same place.
class TileLattice {
 public:
  // The finest on which the positions, at least one, take `bits` (at most 16) a coordinate.
  TileLattice(std::span<const glm::vec3> positions, int bits);

  // Object units.
  [[nodiscard]] double step() const noexcept { return step_; }
  // Where integers count from in y-up axes: least x, largest y, least z of the object's axes.
  [[nodiscard]] glm::dvec3 origin() const noexcept;
  // The nearest point, for one of the positions; at (0, 0, 0) are the least coordinates.
  [[nodiscard]] glm::u16vec3 at(const glm::vec3& position) const;
  [[nodiscard]] glm::dvec3 position(const glm::u16vec3& at) const;
  // The largest coordinates.
  [[nodiscard]] const glm::u16vec3& far_end() const noexcept { return far_end_; }

 private:
  double step_;
  glm::dvec3 least_;  // in steps
  glm::u16vec3 far_end_;
};

// Boxes of tiles, in double precision: contents may lie beside the floats of the HLOD.

// Of nothing, at first.
struct TileBox {
  glm::dvec3 min{std::numeric_limits<double>::infinity()};
  glm::dvec3 max{-std::numeric_limits<double>::infinity()};

  [[nodiscard]] bool is_empty() const noexcept { return !(min.x <= max.x); }
  void take(const glm::dvec3& point) {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
  void take(const TileBox& box) {
    min = glm::min(min, box.min);
    max = glm::max(max, box.max);
  }
};

// No thinner than a millionth of its largest extent, and no point: some clients cannot do with a flat box.
[[nodiscard]] inline TileBox thickened(TileBox box) {
  const glm::dvec3 extent = box.max - box.min;
  const glm::dvec3 farthest = glm::max(glm::abs(box.min), glm::abs(box.max));
  const double largest =
      std::max({extent.x, extent.y, extent.z, 1e-6 * std::max({farthest.x, farthest.y, farthest.z})});
  const double least = largest > 0.0 ? 1e-6 * largest : 1e-6;
  for (int k = 0; k < 3; ++k) {
    if (extent[k] >= least) continue;
    box.min[k] -= least / 2.0;
    box.max[k] += least / 2.0;
  }
  return box;
}

// The content of a tile: a binary glTF file.

struct TileFormat {
  Compression compression = Compression::none;
  int quantise_bits = 0;  // 0: floats
};

// What the materials of an HLOD look like.
struct TileLook {
  std::span<const Material> materials;
  std::span<const Texture> textures;
  std::vector<std::string> images;  // by texture: its uri from a content; empty: left out
  TextureOrigin origin = TextureOrigin::top_left;
};

struct TileContent {
  std::string bytes;  // of the file
  TileBox box;        // of its vertices, as they are decoded
};

// Y up, as glTF has it: clients turn that to z up. Positions count from a place within the tile's box, or from a plane
// of the origin where that is as near, so that as floats they are exact; as integers from a lattice that neighbours of
// about the same size share. A content has the
// materials that it uses. `tile` has triangles. Fails for files of more than 4 GiB. O(n).
[[nodiscard]] TileContent encode_tile(const TileMesh& tile, const TileLook& look, const TileFormat& format,
                                      const FileErrors& errors);

}  // namespace occlod::tiles
