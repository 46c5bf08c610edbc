// Says of every triangle of a refined mesh how it came about and what it is good for.
#pragma once

#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "objects.h"
#include "occlod/refiner.h"
#include "palette.h"
#include "raster/depth_pyramid.h"

namespace occlod::viewer {

// The split that inserted each triangle, no_id for those of the base mesh. In any order. O(triangles).
[[nodiscard]] std::vector<SplitId> born_splits(const Hierarchy& hierarchy, std::span<const Triangle> triangles);

// `items` was drawn for `view` with triangle i as item first_item + i.
[[nodiscard]] std::vector<Seen> classify(const PlacedObject& object, std::span<const Triangle> triangles,
                                         const View& view, const std::vector<bool>& owns_pixel, std::size_t first_item);

// `occluder`: null = nothing is hidden. O(triangles * log(splits)).
[[nodiscard]] std::vector<Outcome> outcomes(const PlacedObject& object, const RefinedObject& refined, const View& view,
                                            const DepthPyramid* occluder);

enum class ErrorOf { shape, attributes };

// What one triangle may differ from the input by, in pixels: the quadric error, or the error of attributes (how far
// textures, hard normals and colours slip), of the largest split that has not been applied at its corners; 0 when there
// is none.
[[nodiscard]] std::vector<double> errors_px(const PlacedObject& object, const RefinedObject& refined, const View& view,
                                            ErrorOf what = ErrorOf::shape);

}  // namespace occlod::viewer
