// Converts loaded objects to those that are refined and drawn.
#pragma once

#include <span>
#include <vector>

#include "occlod/device.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"
#include "occlod/view.h"

namespace occlod::tool {

[[nodiscard]] std::vector<RefineObject> refine_objects(const std::vector<LoadedObject>& objects);

// The result points to the HLODs.
[[nodiscard]] std::vector<hlod::PlacedHlod> placed_objects(const std::vector<LoadedHlod>& hlods);

// The results point into the arguments.
[[nodiscard]] DrawObject draw_object(const LoadedObject& object, std::span<const Triangle> triangles);
[[nodiscard]] std::vector<DrawObject> draw_objects(const std::vector<LoadedObject>& objects,
                                                   const Refinement& refinement);

// Returns where each object's corners lie on textures, without images: one entry per object, or none when no object has
// texture coordinates. They point into the hierarchies.
[[nodiscard]] std::vector<ObjectTexture> texture_coordinates(const std::vector<LoadedObject>& objects);

}  // namespace occlod::tool
