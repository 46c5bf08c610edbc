// Encodes the content of a tile as a binary glTF file, optionally quantised and compressed.
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

// Holds what an accessor reads: elements of one size, as little-endian bytes.
class ByteStream {
 public:
  ByteStream(std::size_t stride, std::size_t count) : stride_(stride), count_(count) { bytes_.reserve(stride * count); }

  // Appends the numbers, which amount to `count` times `stride` bytes over all calls.
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

// Returns whether the library is built with meshoptimizer. Otherwise the next three functions, which implement
// EXT_meshopt_compression, must not be called.
[[nodiscard]] bool has_meshopt() noexcept;

// Orders triangles for vertex caches and wedges by first use, which helps the codecs.
void order_for_codec(GlbPrimitive& primitive);

// Encodes in mode ATTRIBUTES, version 0, without a filter.
[[nodiscard]] std::string encode_vertices(const ByteStream& stream);

// Encodes in mode TRIANGLES, version 1. Decoding may rotate triangles.
[[nodiscard]] std::string encode_triangles(std::span<const std::uint32_t> indices, std::size_t vertices);

// Returns an origin relative to which all positions are exact as floats. For each coordinate it is 0 if the box reaches
// to within half of its extent of 0, else the middle of the box. Then differences are multiples of the last place of
// the smallest coordinate, and no larger than that coordinate.
[[nodiscard]] glm::dvec3 near_origin(std::span<const glm::vec3> positions);

// Holds a lattice of points near some positions, whose coordinates are multiples of a power of two. All lattices of one
// step have the same points, so tiles of about the same size round a shared vertex to the same place.
class TileLattice {
 public:
  // Chooses the finest lattice on which the positions, at least one, take `bits` (at most 16) per coordinate.
  TileLattice(std::span<const glm::vec3> positions, int bits);

  // Returns the distance of neighbouring points, in object units.
  [[nodiscard]] double step() const noexcept { return step_; }
  // Returns the origin of the integers in y-up axes: least x, largest y and least z of the object's axes.
  [[nodiscard]] glm::dvec3 origin() const noexcept;
  // Returns the nearest lattice point to one of the positions; (0, 0, 0) has the least coordinates.
  [[nodiscard]] glm::u16vec3 at(const glm::vec3& position) const;
  [[nodiscard]] glm::dvec3 position(const glm::u16vec3& at) const;
  // Returns the largest coordinates.
  [[nodiscard]] const glm::u16vec3& far_end() const noexcept { return far_end_; }

 private:
  double step_;
  glm::dvec3 least_;  // in steps
  glm::u16vec3 far_end_;
};

// Holds the box of a tile in double precision, because contents may lie beside the floats of the HLOD. It starts empty.
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

// Returns the box made no thinner than a millionth of its largest extent, and never a point: some clients fail on flat
// boxes.
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

struct TileFormat {
  Compression compression = Compression::none;
  int quantise_bits = 0;  // 0: floats
};

// Describes the appearance of the materials of an HLOD, and names its features.
struct TileLook {
  std::span<const Material> materials;
  std::span<const Texture> textures;
  std::vector<std::string> images;  // per texture, its URI relative to a content; empty: left out
  TextureOrigin origin = TextureOrigin::top_left;
  std::span<const std::string> feature_names = {};
};

struct TileContent {
  std::string bytes;  // contents of the file
  TileBox box;        // around its decoded vertices
};

// Returns a tile in glTF's y-up axes, which clients turn to z up. As floats, positions are relative to a place within
// the tile's box, or to a plane of the origin that is as near, so that they are exact; as integers, to a lattice that
// neighbours of about the same size share. The file has only the materials that it uses. `tile` must have triangles.
// Throws Error for files of more than 4 GiB. O(n).
[[nodiscard]] TileContent encode_tile(const TileMesh& tile, const TileLook& look, const TileFormat& format,
                                      const FileErrors& errors);

}  // namespace occlod::tiles
