#include "scene/item_table.h"

#include <algorithm>
#include <cassert>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

namespace occlod {
namespace picture {

ItemTable::ItemTable(std::span<const DrawObject> objects) : objects_(objects), first_items_(1, 0) {
  for (const DrawObject& object : objects)
    first_items_.push_back(first_items_.back() + static_cast<std::uint32_t>(object.triangles.size()));
}

ItemTable::Owner ItemTable::owner(std::uint32_t item) const {
  assert(item < size());
  const auto next = std::upper_bound(first_items_.begin(), first_items_.end(), item);
  const auto object = static_cast<std::size_t>(next - first_items_.begin()) - 1;
  return {&objects_[object], &objects_[object].triangles[item - first_items_[object]]};
}

std::array<glm::dvec3, 3> world_corners(const ItemTable::Owner& owner) {
  std::array<glm::dvec3, 3> corners;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec4 position(owner.object->positions[(*owner.triangle)[i]], 1.0);
    corners[static_cast<std::size_t>(i)] = glm::dvec3(owner.object->object_to_world * position);
  }
  return corners;
}

}  // namespace picture

void draw_items(ItemBuffer& target, std::span<const DrawObject> objects, const View& view) {
  const picture::ItemTable table(objects);
  target.reset(view.width(), view.height());
  for (std::size_t i = 0; i < objects.size(); ++i)
    draw_items(target, objects[i].positions, objects[i].triangles,
               ObjectView(view, objects[i].object_to_world).object_to_clip(), table.first_item(i));
}

}  // namespace occlod
