// Whether what is drawn for a cell of space shows all that its eyes see, looked at from many of them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "occlod/viewcells/cell_builder.h"
#include "oracle/random_shapes.h"

namespace occlod::test {

// Pixels of square images to all six sides of some eyes.
struct CellSight {
  std::size_t pixels = 0;   // that show the front of the input, or either side of a two-sided object
  std::size_t backs = 0;    // that show other backs: they break the condition, and nothing is said about them
  std::size_t missing = 0;  // of `pixels`: no face that is drawn, or that turns away from all of the cell, is within
                            // the tolerance of what they show
};

// Eyes: the corners of the cell, its middle, and `random_eyes` more of it. `image_size`: pixels along each side; the
// focal length of `options` decides how large a pixel of the tolerance is.
[[nodiscard]] CellSight look_from(const CellBox& cell, std::span<const RefineObject> objects,
                                  const CellOptions& options, const CellCut& cut, int random_eyes, int image_size,
                                  RandomShapes& random);

// Triangles of those to draw that own a pixel of any such eye: fewer would do only where nothing is seen between eyes
// and pixels.
[[nodiscard]] std::size_t count_seen(const CellBox& cell, std::span<const RefineObject> objects, double near,
                                     const CellCut& cut, int random_eyes, int image_size, RandomShapes& random);

// That sees a quarter of a turn, of so many pixels along each side.
[[nodiscard]] EyeModel cube_eyes(double image_size, double near);

}  // namespace occlod::test
