// From the number of an item back to the triangle.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/picture/picture.h"

namespace occlod::picture {

// Items are numbered as draw_items() does: object by object.
class ItemTable {
 public:
  explicit ItemTable(std::span<const DrawObject> objects);

  [[nodiscard]] std::size_t size() const noexcept { return first_items_.back(); }
  [[nodiscard]] std::uint32_t first_item(std::size_t object) const noexcept { return first_items_[object]; }

  struct Owner {
    const DrawObject* object;
    const Triangle* triangle;
  };
  // Precondition: item < size().
  [[nodiscard]] Owner owner(std::uint32_t item) const;

 private:
  std::span<const DrawObject> objects_;
  std::vector<std::uint32_t> first_items_;  // of each object, and the end
};

// The corners in world space.
[[nodiscard]] std::array<glm::dvec3, 3> world_corners(const ItemTable::Owner& owner);

}  // namespace occlod::picture
