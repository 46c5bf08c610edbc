// The shading that all pictures share; what differs is the colour of a triangle.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>

#include "occlod/picture/picture.h"
#include "scene/item_table.h"

namespace occlod::picture {

// Linear colours of the three corners of an item, and an image that multiplies them.
struct ItemColor {
  ItemColor(const glm::vec3& color) : corners{color, color, color} {}  // NOLINT: the same everywhere
  ItemColor(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) : corners{a, b, c} {}

  std::array<glm::vec3, 3> corners;
  const TextureImage* image = nullptr;
  std::array<glm::dvec2, 3> coordinates{};  // of the image
};
using ColorOfItem = std::function<ItemColor(std::uint32_t item, const ItemTable::Owner& owner)>;

struct Style {
  bool wire = true;
  glm::vec3 background_top{0.0F};  // linear
  glm::vec3 background_bottom{0.0F};
  glm::dvec3 key_light{-0.60, 0.75, 0.45};  // towards the light: right, up and towards the viewer
};

[[nodiscard]] Image shade_items(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                                const Style& style, const ColorOfItem& color_of_item);

}  // namespace occlod::picture
