// Materials while a file is read: conversion of colours, material libraries of OBJ files, and a table of materials by
// name.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "base/file_input.h"
#include "base/text.h"
#include "mesh/polygon_soup.h"
#include "occlod/mesh.h"

namespace occlod {

// These functions convert between sRGB, in which files and meshes have vertex colours, and linear light (IEC
// 61966-2-1). Arguments and results are in [0, 1]; other arguments are clamped and NaN becomes 0.
[[nodiscard]] inline double srgb_to_linear(double encoded) noexcept {
  const double v = encoded > 0.0 ? std::min(encoded, 1.0) : 0.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}
[[nodiscard]] inline double linear_to_srgb(double linear) noexcept {
  const double v = linear > 0.0 ? std::min(linear, 1.0) : 0.0;
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

// How a map_ line transforms texture coordinates: it shows its image at scale * coordinate + offset.
struct MapPlacement {
  glm::dvec2 scale{1.0};   // -s, finite
  glm::dvec2 offset{0.0};  // -o, finite
  [[nodiscard]] bool operator==(const MapPlacement&) const = default;
};

// Replaces each texture of a material by what `change` returns for it.
template <class Change>
void change_textures(Material& material, const Change& change) {
  Surface& surface = material.surface;
  for (TextureId* const id : {&material.texture, &surface.metallic_map.texture, &surface.normal_map.texture,
                              &surface.occlusion_map.texture, &surface.emissive_map.texture})
    if (*id != no_texture) *id = change(*id);
}

// What a map_ line says.
struct MtlMap {
  Texture texture;              // its file as the text names it; empty when there is none
  MapPlacement placement = {};  // how the texture is placed
};

// The contents of a newmtl block, as far as Material has fields for them.
struct MtlMaterial {
  Material material;      // without its textures
  MtlMap color = {};      // map_Kd
  MtlMap normals = {};    // norm
  MtlMap emission = {};   // map_Ke
  LeftOut left_out = {};  // keywords and options that were not read
};

// Reads newmtl, Kd, d, Tr, Ke, Pr, Pm, map_Kd, map_Ke and norm, with the options -clamp, -o and -s of maps, in upper or
// lower case; everything else is counted by its keyword. A material with map_Ke and without Ke shows that map as it is.
// `text` is UTF-8, or has names in another encoding whose bytes are kept. Throws Error for numbers that cannot be read
// and for values before the first newmtl. O(n).
[[nodiscard]] std::vector<MtlMaterial> parse_mtl(std::string_view text, const FileErrors& errors);

// Ids have 16 bits, and the last one means "no texture".
inline constexpr std::size_t max_materials = no_texture;

// Returns a name in a file as UTF-8; what is not is taken for Latin-1.
[[nodiscard]] inline std::string readable(std::string_view bytes) {
  return is_utf8(bytes) ? std::string(bytes) : from_latin1(bytes);
}

// The materials and textures of a file while it is read. Adds to the lists of a soup, which outlives it.
class MaterialTable {
 public:
  explicit MaterialTable(SoupTables& soup) : soup_(soup) {}

  // Finds the material of this name and adds it if it is missing. Returns false when there are too many.
  [[nodiscard]] bool find_or_add(std::string_view bytes, MaterialId& id) {
    const std::string name = readable(bytes);
    const auto found = by_name_.find(name);
    if (found != by_name_.end()) {
      id = found->second;
      return true;
    }
    if (soup_.materials.size() == max_materials) return false;
    id = static_cast<MaterialId>(soup_.materials.size());
    soup_.materials.push_back({.name = name});
    by_name_.emplace(name, id);
    return true;
  }
  // Returns the material of this name, or null.
  [[nodiscard]] Material* find(std::string_view bytes) {
    const auto found = by_name_.find(readable(bytes));
    return found == by_name_.end() ? nullptr : &soup_.materials[found->second];
  }
  // Returns the texture with this file and these wrap modes and adds it if it is missing; no_texture where there are
  // too many.
  [[nodiscard]] TextureId texture(Texture texture) {
    const auto [found, added] = textures_.try_emplace({texture.file, texture.wrap_s, texture.wrap_t},
                                                      static_cast<TextureId>(soup_.textures.size()));
    if (added && found->second != no_texture) soup_.textures.push_back(std::move(texture));
    return found->second;
  }

 private:
  SoupTables& soup_;
  std::map<std::string, MaterialId, std::less<>> by_name_;
  std::map<std::tuple<std::string, TextureWrap, TextureWrap>, TextureId> textures_;
};

}  // namespace occlod
