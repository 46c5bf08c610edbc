// Materials and textures of glTF files, as far as the base colour goes.
#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "mesh/gltf_accessor.h"
#include "mesh/polygon_soup.h"

namespace occlod {

// How a material looks up its base colour texture.
struct GltfLookup {
  int set = 0;                  // TEXCOORD_<set>
  bool is_transformed = false;  // KHR_texture_transform, applied from here on:
  glm::dvec2 row_u{1.0, 0.0};   // u' = dot(row_u, uv) + offset.x
  glm::dvec2 row_v{0.0, 1.0};   // v' = dot(row_v, uv) + offset.y
  glm::dvec2 offset{0.0};
};

// Fills the materials and textures of a soup: all materials of the file in their order, and, where a primitive has
// none, one without a name behind them. Throws Error for textures and images that are not there.
class GltfMaterials {
 public:
  GltfMaterials(GltfViews& views, PolygonSoup& soup);

  // The id of a material of the file; negative: of a primitive without. Throws Error where it is not there.
  [[nodiscard]] MaterialId id_of(int material);
  // The same material's.
  [[nodiscard]] const GltfLookup& lookup(MaterialId id) const { return lookups_[id]; }

 private:
  void add(const tinygltf::Material& material);
  [[nodiscard]] TextureId texture(int index);
  void fill(Texture& texture, int image_index);

  GltfViews& views_;
  PolygonSoup& soup_;
  std::vector<GltfLookup> lookups_;  // by material
  std::map<int, TextureId> textures_;
};

}  // namespace occlod
