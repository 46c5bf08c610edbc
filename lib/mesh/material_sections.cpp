#include "mesh/material_sections.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

namespace occlod::sections {
namespace {

using Json = nlohmann::json;

constexpr std::string_view materials_name = "MATE", images_name = "TEXI";
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

std::optional<Materials> unpack(std::string_view text, std::span<const std::uint8_t> images) {
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

}  // namespace

void MaterialSections::pack(std::span<const Material> materials, std::span<const Texture> textures,
                            TextureOrigin origin) {
  Json json = {{"materials", Json::array()}, {"textures", Json::array()}};
  json["origin"] = origin == TextureOrigin::bottom_left ? "bottom_left" : "top_left";
  for (const Material& material : materials) json["materials"].push_back(to_json(material));
  for (const Texture& texture : textures) {
    json["textures"].push_back(to_json(texture));
    images_.insert(images_.end(), texture.bytes.begin(), texture.bytes.end());
  }
  // Names may hold anything.
  text_ = json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void MaterialSections::add_to(SectionWriter& writer) const {
  writer.add(materials_name, std::span<const char>(text_));
  writer.add(images_name, std::span<const std::uint8_t>(images_));
}

Materials read_materials(SectionReader& reader) {
  if (!reader.has(materials_name)) return {};
  const auto text = reader.read<char>(materials_name);
  auto materials = unpack({text.data(), text.size()}, reader.read<std::uint8_t>(images_name));
  if (!materials) reader.refuse("section MATE", "does not hold materials");
  return *std::move(materials);
}

}  // namespace occlod::sections
