#include "drawing.h"

namespace occlod::tool {

std::vector<RefineObject> refine_objects(const std::vector<LoadedObject>& objects) {
  std::vector<RefineObject> result;
  for (const LoadedObject& object : objects)
    result.push_back({object.hierarchy.get(), object.object_to_world, object.two_sided, object.attributes});
  return result;
}

std::vector<hlod::PlacedHlod> placed_objects(const std::vector<LoadedHlod>& hlods) {
  std::vector<hlod::PlacedHlod> placed;
  for (const LoadedHlod& hlod : hlods) placed.push_back({hlod.hlod.get(), hlod.object_to_world, hlod.two_sided});
  return placed;
}

DrawObject draw_object(const LoadedObject& object, std::span<const Triangle> triangles) {
  return {object.hierarchy->positions(), object.hierarchy->data().colors, triangles, object.object_to_world};
}

std::vector<DrawObject> draw_objects(const std::vector<LoadedObject>& objects, const Refinement& refinement) {
  std::vector<DrawObject> result;
  for (std::size_t i = 0; i < objects.size(); ++i)
    result.push_back(draw_object(objects[i], refinement.objects[i].triangles));
  return result;
}

std::vector<ObjectTexture> texture_coordinates(const std::vector<LoadedObject>& objects) {
  std::vector<ObjectTexture> result;
  bool has_any = false;
  for (const LoadedObject& object : objects) {
    const HierarchyView& hierarchy = object.hierarchy->data();
    result.push_back({.coordinates = hierarchy.texture_coordinates, .vertex_materials = hierarchy.wedge_materials});
    has_any = has_any || !hierarchy.texture_coordinates.empty();
  }
  if (!has_any) result.clear();
  return result;
}

}  // namespace occlod::tool
