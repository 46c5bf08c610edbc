// EXT_meshopt_compression, by meshoptimizer where the library is built with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "mesh/glb_primitives.h"
#include "hlod/tiles/byte_stream.h"

namespace occlod::tiles {

// Whether the build can. Where not, nothing else here may be called.
[[nodiscard]] bool has_meshopt() noexcept;

// Orders triangles for vertex caches and wedges by first use, which the codecs make use of.
void order_for_codec(GlbPrimitive& primitive);

// Mode ATTRIBUTES, version 0, without a filter.
[[nodiscard]] std::string encode_vertices(const ByteStream& stream);

// Mode TRIANGLES, version 1. Decoding may rotate triangles.
[[nodiscard]] std::string encode_triangles(std::span<const std::uint32_t> indices, std::size_t vertices);

}  // namespace occlod::tiles
