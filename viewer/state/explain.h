// Explains every triangle of a refined mesh: how it came about and what it contributes.
#pragma once

#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "objects.h"
#include "occlod/refiner.h"
#include "palette.h"
#include "raster/depth_pyramid.h"

namespace occlod::viewer {

// Returns the split that inserted each triangle; no_id for the base mesh. Triangles may be in any order. O(triangles).
[[nodiscard]] std::vector<SplitId> born_splits(const Hierarchy& hierarchy, std::span<const Triangle> triangles);

// Classifies triangles. The item buffer of `owns_pixel` was drawn for `view` with triangle i as item first_item + i.
[[nodiscard]] std::vector<Seen> classify(const PlacedObject& object, std::span<const Triangle> triangles,
                                         const View& view, const std::vector<bool>& owns_pixel, std::size_t first_item);

// Returns what ended refinement at each triangle. With a null `occluder` nothing is hidden. O(triangles * log(splits)).
[[nodiscard]] std::vector<Outcome> outcomes(const PlacedObject& object, const RefinedObject& refined, const View& view,
                                            const DepthPyramid* occluder);

enum class ErrorOf { shape, attributes };

// Returns, per triangle, the error to the input in pixels of the largest unapplied split at its corners: the quadric
// error, or that of attributes (how far textures, hard normals and colours slip); 0 if there is no such split.
[[nodiscard]] std::vector<double> errors_px(const PlacedObject& object, const RefinedObject& refined, const View& view,
                                            ErrorOf what = ErrorOf::shape);

}  // namespace occlod::viewer
