// Materials and textures of glTF files.
#pragma once

#include <cstdint>
#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/gltf_accessor.h"
#include "mesh/polygon_soup.h"
#include "mesh/tinygltf.h"

namespace occlod {

// How a material looks up its images: KHR_texture_transform shows them at matrix * coordinate + offset.
struct GltfLookup {
  int set = 0;  // TEXCOORD_<set>
  glm::dvec2 offset{0.0}, scale{1.0};
  double rotation = 0.0;

  [[nodiscard]] bool is_transformed() const {
    return offset != glm::dvec2(0.0) || scale != glm::dvec2(1.0) || rotation != 0.0;
  }
  [[nodiscard]] glm::dmat2 matrix() const;
};

// Fills the materials and textures of a soup: all materials of the file in their order, followed by one without a name
// if a primitive has no material. The texture coordinates of a mesh are those that the base colour's texture is shown
// at, or the first other texture; a map that needs others is left out. Throws Error for textures and images that do not
// exist.
class GltfMaterials {
 public:
  GltfMaterials(GltfViews& views, SoupTables& soup);

  // Returns the id of a material of the file; a negative number stands for a primitive without material. Throws Error
  // when the material does not exist.
  [[nodiscard]] MaterialId id_of(int material);
  // Returns where a material shows its images.
  [[nodiscard]] const GltfLookup& lookup(MaterialId id) const { return lookups_[id]; }

 private:
  // A reference of a material to a texture.
  struct Reference {
    std::string_view name;
    int index = -1;
    double strength = 1.0;
    GltfLookup lookup;
  };

  void add(const tinygltf::Material& material);
  [[nodiscard]] Reference set_base_color(const tinygltf::Material& material, Material& added);
  [[nodiscard]] TextureMap map_of(const Reference& reference, const GltfLookup& coordinates);
  [[nodiscard]] TextureId texture(int index);
  [[nodiscard]] int source_of(const tinygltf::Texture& texture);
  void fill(Texture& texture, int image_index);

  GltfViews& views_;
  SoupTables& soup_;
  std::vector<GltfLookup> lookups_;  // by material
  std::map<int, TextureId> textures_;
};

}  // namespace occlod
