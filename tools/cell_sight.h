// Checks by sampling whether what is drawn for a cell of space shows all that its eyes see.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "full_scene.h"
#include "occlod/cell_builder.h"

namespace occlod::tool {

// Counts pixels of square images to all six sides of some eyes.
struct CellSight {
  std::size_t pixels = 0;  // show the front of the input, or either side of a two-sided object
  std::size_t backs = 0;   // show other backs: they break the condition, and are not checked
  // Counts those of `pixels` with no face within the tolerance that is drawn or turned away from the whole cell.
  std::size_t missing = 0;
};

// Chooses eyes of a cell: its corners, its middle, and random ones.
struct CellEyes {
  int random = 0;          // number of random eyes
  int image_size = 256;    // pixels along each side; the options' focal length sets the size of a pixel
  std::uint64_t seed = 1;  // of the random eyes
};

// Compares the cut with the full scene, which consists of the same objects. A pixel beyond the corners of the images
// that the options assume counts as if it were in such a corner.
[[nodiscard]] CellSight look_from(const CellBox& cell, const FullScene& scene, std::span<const RefineObject> objects,
                                  const CellOptions& options, std::span<const CellObjectCut> cut, const CellEyes& eyes);

// Returns the number of drawn triangles that own a pixel of any such eye. Fewer would do only if nothing were seen
// between eyes and between pixels.
[[nodiscard]] std::size_t count_seen(const CellBox& cell, std::span<const RefineObject> objects, double near,
                                     std::span<const CellObjectCut> cut, const CellEyes& eyes);

// Returns, per triangle of the scene, the pixels of the kind of CellSight::pixels that such eyes see of it.
[[nodiscard]] std::vector<std::uint32_t> count_pixels(const CellBox& cell, const FullScene& scene,
                                                      std::span<const RefineObject> objects, double near,
                                                      const CellEyes& eyes);

// Returns an eye with a field of view of 90 degrees and images of `image_size` pixels along each side.
[[nodiscard]] EyeModel cube_eyes(double image_size, double near);

}  // namespace occlod::tool
