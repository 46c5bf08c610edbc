// What the middle of a cell sees of boxes: the cheapest proof that one is not hidden.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "occlod/mesh/triangle_mesh.h"
#include "occlod/viewcells/cell_view.h"
#include "raster/depth_image.h"
#include "cells/cell_surface.h"

namespace occlod {

// Depth images of a surface to all six sides. Reuses its memory, 25 MB; one thread each.
class CellImages {
 public:
  // Pixels along each side of an image, a multiple of the size of tiles. Half as many leave a third more boxes to the
  // hull test where triangles are small; twice as many take longer to draw than they save.
  static constexpr int size = 1024;

  // The surface outlives it.
  explicit CellImages(const CellSurface& surface);

  // From the middle of the cell. Triangles that come within `near_reach` (world units) of the cell are left out, as
  // they hide nothing. O(what is seen), mostly.
  void draw(const CellBox& cell, double near_reach);

  // Whether a ray through the middle of a pixel enters the box before it meets the surface: up to rounding, no set of
  // triangles hides the box then. Some that touch the box hide it here, though not in the hull test, so false says
  // nothing. O(pixels of the box), mostly less.
  [[nodiscard]] bool show(const CellBox& what);

 private:
  static constexpr int tile_size = 16;  // pixels
  static constexpr int tiles = size / tile_size;
  static constexpr int stride = size + tile_size;  // see DepthImage

  // What lies before one side of the eye. In its space the third axis points away from the eye.
  struct Side {
    int axis = 0;                      // of the world: the third
    double sign = 1.0;                 // its direction
    std::vector<float> nearness;       // see DepthBuffer
    std::vector<float> farthest;       // nearness of the farthest pixel, by tile
    std::vector<bool> farthest_known;  // by tile; not where something has been drawn since
  };
  // A box before a side, and the pixels that it may cover.
  struct Image {
    glm::dvec3 min{0.0}, max{0.0};
    PixelRect rect;
  };

  void draw(Side& side);
  void draw_group(Side& side, const TriangleBvh::Group& group);
  [[nodiscard]] Image image_of(const Side& side, const CellBox& what) const;
  [[nodiscard]] bool show(Side& side, const CellBox& what);
  [[nodiscard]] bool shows_in_tile(const Side& side, const Image& image, const PixelRect& rect) const;
  [[nodiscard]] static float farthest(Side& side, int x, int y);

  const CellSurface& surface_;
  CellBox cell_;
  glm::dvec3 eye_{0.0};
  double near_reach_ = 0.0;
  double near_ = 0.0;                                   // plane
  std::array<double, size> steps_{}, inverse_steps_{};  // of rays, per unit along the third axis, by pixel
  std::array<Side, 6> sides_;
  std::vector<glm::vec3> positions_;  // of a group, from the eye
  std::vector<Triangle> triangles_;
};

}  // namespace occlod
