// How far a refined view is from the truth.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "occlod/picture/compare.h"
#include "occlod/refine/refiner.h"
#include "occlod/scene/scene.h"

namespace occlod::tool {

// Between a drawn refinement and the full meshes of the same objects.
[[nodiscard]] PictureDistance distance_to_full_mesh(const std::vector<LoadedObject>& objects, const View& view,
                                                    const ItemBuffer& items, std::span<const DrawObject> refined);

// Refines to a tolerance of 1 px without a budget, once with `visibility` and once without any occlusion, otherwise as
// `options` say, and counts the pixels of the second picture that the first cannot explain within the two promised
// errors: something visible was held to be hidden.
[[nodiscard]] std::size_t count_wrongly_hidden(const std::vector<LoadedObject>& objects, const View& view,
                                               const RefineOptions& options, Visibility& visibility);

}  // namespace occlod::tool
