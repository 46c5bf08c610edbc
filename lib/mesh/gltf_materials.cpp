#include "mesh/gltf_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/files_beside.h"
#include "mesh/material_table.h"

namespace occlod {
namespace {

TextureWrap wrap_of(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return TextureWrap::clamp;
  return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? TextureWrap::mirror : TextureWrap::repeat;
}

double number_or(const tinygltf::Value& value, double otherwise) {
  return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

glm::dvec2 pair_or(const tinygltf::Value& value, double otherwise) {
  glm::dvec2 pair(otherwise);
  if (!value.IsArray()) return pair;
  for (int k = 0; k < 2 && static_cast<std::size_t>(k) < value.ArrayLen(); ++k)
    pair[k] = number_or(value.Get(k), otherwise);
  return pair;
}

// Counter-clockwise seen with v upwards, so that the example of the extension (offset 0 1, a quarter turn, scale 0.5)
// shows the lower left quarter of the image, as it says.
GltfLookup lookup_of(const tinygltf::TextureInfo& info) {
  GltfLookup lookup;
  lookup.set = std::max(info.texCoord, 0);
  const auto found = info.extensions.find("KHR_texture_transform");
  if (found == info.extensions.end()) return lookup;
  const tinygltf::Value& transform = found->second;
  const glm::dvec2 scale = pair_or(transform.Get("scale"), 1.0);
  const double angle = number_or(transform.Get("rotation"), 0.0);
  lookup.is_transformed = true;
  lookup.offset = pair_or(transform.Get("offset"), 0.0);
  lookup.row_u = {std::cos(angle) * scale.x, std::sin(angle) * scale.y};
  lookup.row_v = {-std::sin(angle) * scale.x, std::cos(angle) * scale.y};
  if (transform.Get("texCoord").IsNumber()) lookup.set = std::max(transform.Get("texCoord").GetNumberAsInt(), 0);
  return lookup;
}

// The image of a texture whose own format is an extension.
int source_of(const tinygltf::Texture& texture) {
  if (texture.source >= 0) return texture.source;
  for (const char* name : {"EXT_texture_webp", "KHR_texture_basisu", "MSFT_texture_dds"}) {
    const auto found = texture.extensions.find(name);
    if (found != texture.extensions.end() && found->second.Get("source").IsNumber())
      return found->second.Get("source").GetNumberAsInt();
  }
  return -1;
}

}  // namespace

GltfMaterials::GltfMaterials(GltfViews& views, PolygonSoup& soup) : views_(views), soup_(soup) {
  const std::vector<tinygltf::Material>& materials = views.model().materials;
  if (materials.size() >= most_materials)
    views.errors().fail("",
                        fmt::format("has {} materials, which is more than {}", materials.size(), most_materials - 1),
                        "split the mesh into parts");
  for (const tinygltf::Material& material : materials) add(material);
}

MaterialId GltfMaterials::id_of(int material) {
  const std::size_t count = views_.model().materials.size();
  if (material >= 0 && static_cast<std::size_t>(material) >= count)
    views_.errors().fail("", fmt::format("refers to material {}, which is not there", material), gltf_remedy);
  if (material >= 0) return static_cast<MaterialId>(material);
  if (soup_.materials.size() == count) {
    soup_.materials.emplace_back();
    lookups_.emplace_back();
  }
  return static_cast<MaterialId>(count);
}

void GltfMaterials::add(const tinygltf::Material& material) {
  const tinygltf::PbrMetallicRoughness& look = material.pbrMetallicRoughness;
  Material& added = soup_.materials.emplace_back();
  added.name = material.name;
  for (int k = 0; k < 4 && static_cast<std::size_t>(k) < look.baseColorFactor.size(); ++k) {
    const double value = look.baseColorFactor[static_cast<std::size_t>(k)];
    added.base_color[k] = value > 0.0 ? static_cast<float>(std::min(value, 1.0)) : 0.0F;
  }
  if (look.baseColorTexture.index >= 0) added.texture = texture(look.baseColorTexture.index);
  lookups_.push_back(lookup_of(look.baseColorTexture));
  for (const int other : {look.metallicRoughnessTexture.index, material.normalTexture.index,
                          material.occlusionTexture.index, material.emissiveTexture.index})
    soup_.left_out.materials += other >= 0;
}

TextureId GltfMaterials::texture(int index) {
  const tinygltf::Model& model = views_.model();
  const FileErrors& errors = views_.errors();
  if (const auto found = textures_.find(index); found != textures_.end()) return found->second;
  if (static_cast<std::size_t>(index) >= model.textures.size())
    errors.fail("", fmt::format("refers to texture {}, which is not there", index), gltf_remedy);
  const tinygltf::Texture& texture = model.textures[static_cast<std::size_t>(index)];
  Texture added;
  const int image = source_of(texture);
  if (image < 0) return textures_.emplace(index, no_texture).first->second;
  fill(added, image);
  if (texture.sampler >= 0) {
    if (static_cast<std::size_t>(texture.sampler) >= model.samplers.size())
      errors.fail("", fmt::format("refers to sampler {}, which is not there", texture.sampler), gltf_remedy);
    const tinygltf::Sampler& sampler = model.samplers[static_cast<std::size_t>(texture.sampler)];
    added.wrap_s = wrap_of(sampler.wrapS);
    added.wrap_t = wrap_of(sampler.wrapT);
  }
  soup_.textures.push_back(std::move(added));
  return textures_.emplace(index, static_cast<TextureId>(soup_.textures.size() - 1)).first->second;
}

void GltfMaterials::fill(Texture& texture, int image_index) {
  const tinygltf::Model& model = views_.model();
  if (static_cast<std::size_t>(image_index) >= model.images.size())
    views_.errors().fail("", fmt::format("refers to image {}, which is not there", image_index), gltf_remedy);
  const tinygltf::Image& image = model.images[static_cast<std::size_t>(image_index)];
  if (!image.uri.empty()) {
    texture.file = file_name_of_uri(image.uri);
    return;
  }
  texture.mime_type = image.mimeType;
  texture.bytes = image.image;  // of a data URI
  if (image.bufferView < 0) return;
  const std::string place = fmt::format("image {}", image_index);
  const GltfViews::View view = views_.view(image.bufferView, place);
  if (view.length > view.bytes.size())
    views_.errors().fail(place, "reaches beyond its buffer: the file was cut or is malformed", gltf_remedy);
  texture.bytes.assign(view.bytes.begin(), view.bytes.begin() + static_cast<std::ptrdiff_t>(view.length));
}

}  // namespace occlod
