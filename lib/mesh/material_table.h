// The materials and textures of a file while it is read.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "mesh/polygon_soup.h"

namespace occlod {

// Ids are 16 bits, of which the last is no texture.
inline constexpr std::size_t most_materials = no_texture;

// Adds to the lists of a soup, which outlives it.
class MaterialTable {
 public:
  explicit MaterialTable(SoupTables& soup) : soup_(soup) {}

  // The material of this name, which is added where there is none. False where there are too many.
  [[nodiscard]] bool find_or_add(std::string_view name, MaterialId& id) {
    const auto found = by_name_.find(name);
    if (found != by_name_.end()) {
      id = found->second;
      return true;
    }
    if (soup_.materials.size() == most_materials) return false;
    id = static_cast<MaterialId>(soup_.materials.size());
    soup_.materials.push_back({.name = std::string(name)});
    by_name_.emplace(name, id);
    return true;
  }
  // The material of this name, or null.
  [[nodiscard]] Material* find(std::string_view name) {
    const auto found = by_name_.find(name);
    return found == by_name_.end() ? nullptr : &soup_.materials[found->second];
  }
  // The texture of a file that repeats like this, which is added where there is none. There are no more textures than
  // materials.
  [[nodiscard]] TextureId texture(Texture texture) {
    const auto [found, added] = textures_.try_emplace({texture.file, texture.wrap_s, texture.wrap_t},
                                                      static_cast<TextureId>(soup_.textures.size()));
    if (added) soup_.textures.push_back(std::move(texture));
    return found->second;
  }

 private:
  SoupTables& soup_;
  std::map<std::string, MaterialId, std::less<>> by_name_;
  std::map<std::tuple<std::string, TextureWrap, TextureWrap>, TextureId> textures_;
};

}  // namespace occlod
