// Whether what is drawn for a cell of space shows all that its eyes see, looked at from many of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "full_scene.h"
#include "occlod/cell_builder.h"

namespace occlod::tool {

// Pixels of square images to all six sides of some eyes.
struct CellSight {
  std::size_t pixels = 0;   // that show the front of the input, or either side of a two-sided object
  std::size_t backs = 0;    // that show other backs: they break the condition, and nothing is said about them
  std::size_t missing = 0;  // of `pixels`: no face that is drawn, or that turns away from all of the cell, is within
                            // the tolerance of what they show
};

// Which eyes of a cell look: its corners, its middle, and some more of it.
struct CellEyes {
  int random = 0;          // so many more
  int image_size = 256;    // pixels along each side; the focal length of options decides how large a pixel of the
                           // tolerance is
  std::uint64_t seed = 1;  // of the random ones
};

// Compares with the full scene, which is made of the same objects and outlives the call. A pixel beyond the corners of
// the images that the options are for counts as if it were in such a corner.
[[nodiscard]] CellSight look_from(const CellBox& cell, const FullScene& scene, std::span<const RefineObject> objects,
                                  const CellOptions& options, std::span<const CellObjectCut> cut, const CellEyes& eyes);

// Triangles of those to draw that own a pixel of any such eye: fewer would do only where nothing is seen between eyes
// and pixels.
[[nodiscard]] std::size_t count_seen(const CellBox& cell, std::span<const RefineObject> objects, double near,
                                     std::span<const CellObjectCut> cut, const CellEyes& eyes);

// What such eyes see of the input: by triangle of the scene, as numbered there, pixels of the kind that
// CellSight::pixels counts.
[[nodiscard]] std::vector<std::uint32_t> count_pixels(const CellBox& cell, const FullScene& scene,
                                                      std::span<const RefineObject> objects, double near,
                                                      const CellEyes& eyes);

// That sees a quarter of a turn, of so many pixels along each side.
[[nodiscard]] EyeModel cube_eyes(double image_size, double near);

}  // namespace occlod::tool
