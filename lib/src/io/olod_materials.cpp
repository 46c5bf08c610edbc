#include <nlohmann/json.hpp>

#include "olod_format.h"

namespace occlod::olod {
namespace {

using Json = nlohmann::json;

constexpr const char* wrap_names[] = {"repeat", "clamp", "mirror"};

TextureWrap wrap_of(const Json& name) {
  for (std::size_t i = 0; i < std::size(wrap_names); ++i)
    if (name == wrap_names[i]) return static_cast<TextureWrap>(i);
  throw Json::other_error::create(501, "no wrap mode", &name);
}

Json to_json(const Texture& texture) {
  return {{"file", texture.file},
          {"mime_type", texture.mime_type},
          {"bytes", texture.bytes.size()},
          {"wrap_s", wrap_names[static_cast<std::size_t>(texture.wrap_s)]},
          {"wrap_t", wrap_names[static_cast<std::size_t>(texture.wrap_t)]}};
}

Json to_json(const Material& material) {
  const glm::vec4& c = material.base_color;
  Json json = {{"name", material.name}, {"base_color", {c.r, c.g, c.b, c.a}}};
  if (material.texture != no_texture) json["texture"] = material.texture;
  return json;
}

Material material_of(const Json& json) {
  Material material;
  material.name = json.at("name").get<std::string>();
  for (int i = 0; i < 4; ++i)
    material.base_color[i] = json.at("base_color").at(static_cast<std::size_t>(i)).get<float>();
  if (json.contains("texture")) material.texture = json["texture"].get<TextureId>();
  return material;
}

}  // namespace

bool needs_wedges(const HierarchyView& view) {
  return !view.extra_wedges.empty() || !view.texture_coordinates.empty() || !view.wedge_materials.empty() ||
         !view.materials.empty() || !view.textures.empty();
}

MaterialSections write_materials(const HierarchyView& view) {
  MaterialSections sections;
  Json json = {{"materials", Json::array()}, {"textures", Json::array()}};
  json["origin"] = view.texture_origin == TextureOrigin::bottom_left ? "bottom_left" : "top_left";
  for (const Material& material : view.materials) json["materials"].push_back(to_json(material));
  for (const Texture& texture : view.textures) {
    json["textures"].push_back(to_json(texture));
    sections.images.insert(sections.images.end(), texture.bytes.begin(), texture.bytes.end());
  }
  // Names may hold anything.
  sections.text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return sections;
}

std::optional<Materials> read_materials(std::string_view text, std::span<const std::uint8_t> images) {
  try {
    const Json json = Json::parse(text);
    Materials result;
    const std::string origin = json.at("origin").get<std::string>();
    if (origin != "bottom_left" && origin != "top_left") return std::nullopt;
    result.origin = origin == "bottom_left" ? TextureOrigin::bottom_left : TextureOrigin::top_left;
    for (const Json& material : json.at("materials")) result.materials.push_back(material_of(material));
    for (const Json& texture : json.at("textures")) {
      const auto size = texture.at("bytes").get<std::size_t>();
      if (size > images.size()) return std::nullopt;
      result.textures.push_back({texture.at("file").get<std::string>(),
                                 texture.at("mime_type").get<std::string>(),
                                 {images.begin(), images.begin() + static_cast<std::ptrdiff_t>(size)},
                                 wrap_of(texture.at("wrap_s")),
                                 wrap_of(texture.at("wrap_t"))});
      images = images.subspan(size);
    }
    if (!images.empty()) return std::nullopt;
    return result;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace occlod::olod
