#include "hlod/tiles/meshopt_codec.h"

#include <cassert>
#include <vector>

#ifdef OCCLOD_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace occlod::tiles {

#ifdef OCCLOD_HAS_MESHOPTIMIZER

bool has_meshopt() noexcept { return true; }

void order_for_codec(GlbPrimitive& primitive) {
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * primitive.triangles.size());
  for (const Triangle& t : primitive.triangles) indices.insert(indices.end(), {t.x, t.y, t.z});
  const std::size_t vertices = primitive.wedges.size();
  meshopt_optimizeVertexCacheStrip(indices.data(), indices.data(), indices.size(), vertices);
  std::vector<std::uint32_t> place(vertices);
  const std::size_t used = meshopt_optimizeVertexFetchRemap(place.data(), indices.data(), indices.size(), vertices);
  std::vector<WedgeId> wedges(used);
  for (std::size_t v = 0; v < vertices; ++v)
    if (place[v] != no_id) wedges[place[v]] = primitive.wedges[v];
  primitive.wedges = std::move(wedges);
  for (std::size_t t = 0; t < primitive.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) primitive.triangles[t][k] = place[indices[3 * t + static_cast<std::size_t>(k)]];
}

std::string encode_vertices(const ByteStream& stream) {
  meshopt_encodeVertexVersion(0);
  std::string encoded(meshopt_encodeVertexBufferBound(stream.count(), stream.stride()), '\0');
  encoded.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(encoded.data()), encoded.size(),
                                            stream.bytes().data(), stream.count(), stream.stride()));
  return encoded;
}

std::string encode_triangles(std::span<const std::uint32_t> indices, std::size_t vertices) {
  meshopt_encodeIndexVersion(1);
  std::string encoded(meshopt_encodeIndexBufferBound(indices.size(), vertices), '\0');
  encoded.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(encoded.data()), encoded.size(),
                                           indices.data(), indices.size()));
  return encoded;
}

#else

bool has_meshopt() noexcept { return false; }
void order_for_codec(GlbPrimitive&) { assert(false); }
std::string encode_vertices(const ByteStream&) { return {}; }
std::string encode_triangles(std::span<const std::uint32_t>, std::size_t) { return {}; }

#endif

}  // namespace occlod::tiles
