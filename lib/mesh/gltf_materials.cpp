#include "mesh/gltf_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <optional>
#include <string>
#include <utility>

#include "mesh/data_uri.h"
#include "mesh/materials.h"
#include "mesh/mesh_files.h"

namespace occlod {
namespace {

constexpr const char* specular_name = "KHR_materials_pbrSpecularGlossiness";

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

// Clamps to [0, 1]; NaN becomes 0.
float fraction(double value) { return value > 0.0 ? static_cast<float>(std::min(value, 1.0)) : 0.0F; }

GltfLookup lookup_of(int set, const tinygltf::ExtensionMap& extensions) {
  GltfLookup lookup;
  lookup.set = std::max(set, 0);
  const auto found = extensions.find("KHR_texture_transform");
  if (found == extensions.end()) return lookup;
  const tinygltf::Value& transform = found->second;
  lookup.scale = pair_or(member(transform, "scale"), 1.0);
  lookup.rotation = number_or(member(transform, "rotation"), 0.0);
  lookup.offset = pair_or(member(transform, "offset"), 0.0);
  if (const int other = index_member(transform, "texCoord"); other >= 0) lookup.set = other;
  return lookup;
}

// Places a map at texture coordinates that have been transformed. Returns false where no offset, rotation and scale
// does that.
bool place(const GltfLookup& lookup, const GltfLookup& coordinates, TextureMap& map) {
  const auto set = [&](const glm::dvec2& offset, double rotation, const glm::dvec2& scale) {
    map.offset = offset;
    map.rotation = static_cast<float>(rotation);
    map.scale = scale;
  };
  if (lookup.offset == coordinates.offset && lookup.scale == coordinates.scale &&
      lookup.rotation == coordinates.rotation)
    return true;
  if (!coordinates.is_transformed()) {
    set(lookup.offset, lookup.rotation, lookup.scale);
    return true;
  }
  const glm::dmat2 to_transformed = coordinates.matrix();
  if (glm::determinant(to_transformed) == 0.0) return false;
  const glm::dmat2 matrix = lookup.matrix() * glm::inverse(to_transformed);
  constexpr double tolerance = 1e-9;
  if (!(std::abs(glm::dot(matrix[0], matrix[1])) <= tolerance * glm::length(matrix[0]) * glm::length(matrix[1])))
    return false;
  const double rotation = std::atan2(-matrix[0].y, matrix[0].x);
  const glm::dvec2 scale(glm::length(matrix[0]),
                         glm::dot(matrix[1], glm::dvec2(std::sin(rotation), std::cos(rotation))));
  set(lookup.offset - matrix * coordinates.offset, rotation, scale);
  return true;
}

}  // namespace

// The rotation is counter-clockwise seen with v upwards, so that the example of the extension (offset 0 1, a quarter
// turn, scale 0.5) shows the lower left quarter of the image, as the extension says.
glm::dmat2 GltfLookup::matrix() const {
  const double c = std::cos(rotation), s = std::sin(rotation);
  return {c * scale.x, -s * scale.x, s * scale.y, c * scale.y};
}

GltfMaterials::GltfMaterials(GltfViews& views, SoupTables& soup) : views_(views), soup_(soup) {
  const std::vector<tinygltf::Material>& materials = views.model().materials;
  if (materials.size() >= max_materials)
    views.errors().fail("", fmt::format("has {} materials, which is more than {}", materials.size(), max_materials - 1),
                        "split the mesh into parts");
  for (const tinygltf::Material& material : materials) add(material);
}

MaterialId GltfMaterials::id_of(int material) {
  const std::size_t count = views_.model().materials.size();
  if (material >= 0 && static_cast<std::size_t>(material) >= count)
    views_.errors().fail("", fmt::format("refers to material {}, which is not there", material), gltf_remedy);
  if (material >= 0) return static_cast<MaterialId>(material);
  if (soup_.materials.size() == count) {
    soup_.materials.emplace_back().surface.metallic = 1.0F;  // the default of glTF
    lookups_.emplace_back();
  }
  return static_cast<MaterialId>(count);
}

// Sets the base colour and how metallic it is, and returns the reference to its texture. The older model of specular
// colours counts where a material has it: its diffuse colour is what a base colour is.
GltfMaterials::Reference GltfMaterials::set_base_color(const tinygltf::Material& material, Material& added) {
  const auto specular = material.extensions.find(specular_name);
  Surface& surface = added.surface;
  if (specular == material.extensions.end()) {
    const tinygltf::PbrMetallicRoughness& look = material.pbrMetallicRoughness;
    for (int k = 0; k < 4 && static_cast<std::size_t>(k) < look.baseColorFactor.size(); ++k)
      added.base_color[k] = fraction(look.baseColorFactor[static_cast<std::size_t>(k)]);
    surface.metallic = fraction(look.metallicFactor);
    surface.roughness = fraction(look.roughnessFactor);
    return {"baseColorTexture", look.baseColorTexture.index, 1.0,
            lookup_of(look.baseColorTexture.texCoord, look.baseColorTexture.extensions)};
  }
  const tinygltf::Value& look = specular->second;
  if (const tinygltf::Value& factor = member(look, "diffuseFactor"); factor.IsArray())
    for (int k = 0; k < 4 && static_cast<std::size_t>(k) < factor.ArrayLen(); ++k)
      added.base_color[k] = fraction(number_or(factor.Get(k), 1.0));
  // An image of glossiness is left out, and with it what it multiplies.
  surface.roughness =
      look.Has("specularGlossinessTexture") ? 1.0F : 1.0F - fraction(number_or(member(look, "glossinessFactor"), 1.0));
  const tinygltf::Value& texture = member(look, "diffuseTexture");
  const tinygltf::Value& transform = member(member(texture, "extensions"), "KHR_texture_transform");
  tinygltf::ExtensionMap extensions;
  if (transform.IsObject()) extensions["KHR_texture_transform"] = transform;
  return {"diffuseTexture", index_member(texture, "index"), 1.0,
          lookup_of(index_member(texture, "texCoord"), extensions)};
}

void GltfMaterials::add(const tinygltf::Material& material) {
  Material added;
  added.name = material.name;
  const Reference base = set_base_color(material, added);
  Surface& surface = added.surface;
  const auto reference = [](std::string_view name, const auto& info, double strength) {
    return Reference{name, info.index, strength, lookup_of(info.texCoord, info.extensions)};
  };
  Reference metallic =
      reference("metallicRoughnessTexture", material.pbrMetallicRoughness.metallicRoughnessTexture, 1.0);
  if (material.extensions.contains(specular_name)) metallic.index = -1;  // of the fallback
  const Reference normal = reference("normalTexture", material.normalTexture, material.normalTexture.scale);
  const Reference occlusion =
      reference("occlusionTexture", material.occlusionTexture, material.occlusionTexture.strength);
  const Reference emissive = reference("emissiveTexture", material.emissiveTexture, 1.0);
  GltfLookup coordinates;
  for (const Reference* const it : {&emissive, &occlusion, &normal, &std::as_const(metallic), &base})
    if (it->index >= 0) coordinates = it->lookup;
  if (base.index >= 0) added.texture = texture(base.index);
  surface.metallic_map = map_of(metallic, coordinates);
  surface.normal_map = map_of(normal, coordinates);
  surface.occlusion_map = map_of(occlusion, coordinates);
  surface.emissive_map = map_of(emissive, coordinates);
  for (int k = 0; k < 3 && static_cast<std::size_t>(k) < material.emissiveFactor.size(); ++k)
    surface.emissive[k] = fraction(material.emissiveFactor[static_cast<std::size_t>(k)]);
  surface.double_sided = material.doubleSided;
  surface.unlit = material.extensions.contains("KHR_materials_unlit");
  if (material.alphaMode == "MASK") {
    surface.alpha_mode = AlphaMode::mask;
    surface.alpha_cutoff = material.alphaCutoff > 0.0 ? static_cast<float>(material.alphaCutoff) : 0.0F;
  } else if (material.alphaMode == "BLEND") {
    surface.alpha_mode = added.base_color.a < 1.0F ? AlphaMode::by_color : AlphaMode::blend;
  } else {
    added.base_color.a = 1.0F;  // OPAQUE ignores alpha
  }
  soup_.materials.push_back(std::move(added));
  lookups_.push_back(coordinates);
}

TextureMap GltfMaterials::map_of(const Reference& reference, const GltfLookup& coordinates) {
  TextureMap map;
  if (reference.index < 0) return map;
  map.strength = static_cast<float>(reference.strength);
  if (reference.lookup.set != coordinates.set) {
    soup_.left_out.add(fmt::format("{} (TEXCOORD_{})", reference.name, reference.lookup.set));
    return {};
  }
  if (!place(reference.lookup, coordinates, map)) {
    soup_.left_out.add(fmt::format("{} (KHR_texture_transform)", reference.name));
    return {};
  }
  map.texture = texture(reference.index);
  return map.texture == no_texture ? TextureMap{} : map;
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
  if (image < 0) {
    soup_.left_out.add("textures without an image");
    return textures_.emplace(index, no_texture).first->second;
  }
  fill(added, image);
  if (texture.sampler >= 0) {
    if (static_cast<std::size_t>(texture.sampler) >= model.samplers.size())
      errors.fail("", fmt::format("refers to sampler {}, which is not there", texture.sampler), gltf_remedy);
    const tinygltf::Sampler& sampler = model.samplers[static_cast<std::size_t>(texture.sampler)];
    added.wrap_s = wrap_of(sampler.wrapS);
    added.wrap_t = wrap_of(sampler.wrapT);
    constexpr int nearest = 9728, trilinear = 9987;
    const auto filter = [](int mode) {
      return static_cast<std::uint16_t>(mode >= nearest && mode <= trilinear ? mode : 0);
    };
    added.min_filter = filter(sampler.minFilter);
    added.mag_filter = filter(sampler.magFilter);
  }
  soup_.textures.push_back(std::move(added));
  return textures_.emplace(index, static_cast<TextureId>(soup_.textures.size() - 1)).first->second;
}

// Returns the image of a texture: the one that every reader understands, else one whose format an extension gives.
int GltfMaterials::source_of(const tinygltf::Texture& texture) {
  int source = texture.source;
  for (const char* name : {"EXT_texture_webp", "KHR_texture_basisu", "MSFT_texture_dds", "EXT_texture_avif"}) {
    const auto found = texture.extensions.find(name);
    const int other = found == texture.extensions.end() ? -1 : index_member(found->second, "source");
    if (other < 0) continue;
    if (source < 0)
      source = other;
    else
      soup_.left_out.add(name);
  }
  return source;
}

void GltfMaterials::fill(Texture& texture, int image_index) {
  const tinygltf::Model& model = views_.model();
  if (static_cast<std::size_t>(image_index) >= model.images.size())
    views_.errors().fail("", fmt::format("refers to image {}, which is not there", image_index), gltf_remedy);
  const tinygltf::Image& image = model.images[static_cast<std::size_t>(image_index)];
  const std::string place = fmt::format("image {}", image_index);
  texture.mime_type = image.mimeType;
  if (const auto data = parse_data_uri(image.uri)) {
    const std::string text = file_name_of_uri(data->data);
    std::optional<std::vector<std::uint8_t>> bytes = std::vector<std::uint8_t>(text.begin(), text.end());
    if (data->is_base64) bytes = decode_base64(text);
    if (!bytes || bytes->empty())
      views_.errors().fail(place, fmt::format("its data URI of {} has no valid base64", in_quotes(data->media_type)),
                           gltf_remedy);
    texture.mime_type = data->media_type;
    texture.bytes = *std::move(bytes);
    return;
  }
  if (!image.uri.empty()) {
    texture.mime_type.clear();
    texture.file = file_name_of_uri(image.uri);
    return;
  }
  texture.bytes = image.image;  // from a data URI
  if (image.bufferView < 0) return;
  const GltfViews::View view = views_.view(image.bufferView, place);
  if (view.length > view.bytes.size())
    views_.errors().fail(place, "reaches beyond its buffer: the file was cut or is malformed", gltf_remedy);
  texture.bytes.assign(view.bytes.begin(), view.bytes.begin() + static_cast<std::ptrdiff_t>(view.length));
}

}  // namespace occlod
