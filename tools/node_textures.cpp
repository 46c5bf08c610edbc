#include "node_textures.h"

#include <fmt/format.h>

#include "hlod/texture/image_place.h"
#include "node_image.h"
#include "occlod/base.h"
#include "standard_streams.h"

namespace occlod::tool {

std::vector<ObjectTexture> NodeTextures::of(const FrontMesh& front) {
  std::vector<ObjectTexture> result;
  if (textures_.materials().empty()) return result;
  for (auto& [key, own] : own_) own.is_used = false;
  for (const LaidObject& laid : front.laid()) {
    const bool has_own = textures_.shows_images() && !laid.mesh.image.empty();
    result.push_back(has_own
                         ? own_texture(laid)
                         : ObjectTexture{laid.texture_coordinates, laid.materials, textures_.materials()[laid.placed]});
  }
  std::erase_if(own_, [](const auto& entry) { return !entry.second.is_used; });
  return result;
}

ObjectTexture NodeTextures::own_texture(const LaidObject& laid) {
  const std::uint64_t key = std::uint64_t{laid.placed} << 32U | laid.node;
  auto found = own_.find(key);
  if (found == own_.end()) found = own_.emplace(key, decoded(laid)).first;
  Own& own = found->second;
  own.is_used = true;
  return {own.coordinates, laid.materials, own.materials};
}

NodeTextures::Own NodeTextures::decoded(const LaidObject& laid) const {
  const hlod::HlodView& view = placed_[laid.placed].hlod->data();
  const std::span<const DrawMaterial> materials = textures_.materials()[laid.placed];
  Own own;
  own.materials.assign(materials.begin(), materials.end());
  own.coordinates.assign(laid.texture_coordinates.begin(), laid.texture_coordinates.end());
  try {
    own.image =
        std::make_unique<TextureImage>(image_of_node(laid.mesh, fmt::format("the image of node {}", laid.node)),
                                       TextureAddress{TextureWrap::clamp, TextureWrap::clamp, TextureOrigin::top_left});
  } catch (const Error& error) {
    print_note(std::string(error.what()) + "; the node is drawn without");
  }
  for (std::size_t m = 0; m < own.materials.size(); ++m)
    if (view.image_materials[m] != 0) own.materials[m].image = own.image.get();
  for (std::size_t v = 0; v < own.coordinates.size(); ++v)
    own.coordinates[v] = hlod::image_place(view, laid.mesh, v).value_or(own.coordinates[v]);
  return own;
}

}  // namespace occlod::tool
