// Measures how far a simplified mesh is from the full one in texture, normals and colours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>

#include "occlod/mesh.h"

namespace occlod::measure {

struct AttributeOptions {
  std::size_t samples = 100'000;  // points on the first mesh, stratified by area
  std::uint64_t seed = 1;
  double search_radius = 0.1;  // share of the first mesh's diagonal, > 0, within which a texel is searched for
};

// Measures how far the texture has slipped, in object units: the texture deviation of Cohen, Olano and Manocha
// (Appearance-preserving simplification, SIGGRAPH 1998), along the surface only. A sample p of A shows a texel: a
// texture coordinate t in a material. p' is the point of B nearest to p, where the texel should be. It is at the point
// q of B with that material for which |q - p'| + |t(q) - t| is least; the second length is in object units, by the
// gradient of A's texture coordinates around p. That sum is the slip of p.
//
// Where B shows the texel, t(q) = t, and the slip is the distance to it. Where B has no such texel nearby, because a
// chart has shrunk, the texture is continued beyond the chart's border. A sample whose sum would be the search radius
// or more is lost, and counts as that radius.
struct TextureSlip {
  double rms = 0.0;        // over the samples
  double max = 0.0;        // over the samples
  glm::dvec3 max_at{0.0};  // the point of A with this slip
  std::size_t lost = 0;    // number of lost samples, included above
  double radius = 0.0;     // the search radius
};

// Measures a difference at the nearest point of B; of all equally near points (within 1e-6 of the diagonal), the
// smallest.
struct AttributeDifference {
  double rms = 0.0;  // over the samples
  double max = 0.0;  // over the samples
};

// Holds values for what both meshes have.
struct AttributeDistance {
  std::optional<TextureSlip> texture;
  std::optional<AttributeDifference> normals;  // degrees, between interpolated normals made unit length
  std::optional<AttributeDifference> colors;   // root mean square over red, green and blue, each in [0, 1]
};

// Measures from `a`, the full mesh, to `b`, any other, even from elsewhere. Both have triangles. Materials are equal if
// their names are, or their numbers if they have no names. Expected O((n + samples) log n); far more per sample if much
// of the texture is lost. The same meshes and options give the same numbers.
[[nodiscard]] AttributeDistance attribute_distance(const TriangleMesh& a, const TriangleMesh& b,
                                                   const AttributeOptions& options = {});

}  // namespace occlod::measure
