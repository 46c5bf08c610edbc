// From loaded objects to what is refined and what is drawn.
#pragma once

#include <span>
#include <vector>

#include "occlod/device/device.h"
#include "occlod/picture/picture.h"
#include "occlod/picture/texture_image.h"
#include "occlod/raster/item_buffer.h"
#include "occlod/refine/refiner.h"
#include "occlod/scene/load_hlods.h"
#include "occlod/scene/scene.h"
#include "occlod/view/view.h"

namespace occlod::tool {

[[nodiscard]] std::vector<RefineObject> refine_objects(const std::vector<LoadedObject>& objects);

// Points to them.
[[nodiscard]] std::vector<hlod::PlacedHlod> placed_objects(const std::vector<LoadedHlod>& hlods);

// Both point into their arguments.
[[nodiscard]] DrawObject draw_object(const LoadedObject& object, std::span<const Triangle> triangles);
[[nodiscard]] std::vector<DrawObject> draw_objects(const std::vector<LoadedObject>& objects,
                                                   const Refinement& refinement);

// Where each object's corners lie on textures, without images: one for each object; empty when no object has texture
// coordinates. They point into the hierarchies.
[[nodiscard]] std::vector<ObjectTexture> texture_coordinates(const std::vector<LoadedObject>& objects);

// Empties the buffer and draws all objects.
void redraw(ItemBuffer& items, std::span<const DrawObject> objects, const View& view);

}  // namespace occlod::tool
