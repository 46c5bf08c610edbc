// Occlusion from a cell by shrunk occluders: Chhugani and others 2003, sec. 5.2. From a point that lies inside the
// shadow frusta of all occluders, each is drawn smaller, so that what it hides from the point it hides from all of the
// cell.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "papers/convex_occluder.h"

namespace occlod::paper {

struct ShrunkOptions {
  bool best_point = true;  // by the quadratic programme; false: the middle of the cell
  int resolution = 1024;   // pixels along each side of the images
};

// Six images, one for the occluders in the direction of each face of a cube, from a point of its own.
//
// The paper draws on a GPU. Here pixels count as covered where all of them is, with the largest depth in them, and what
// is asked about counts as all pixels that it touches: so answers are conservative.
class ShrunkOcclusion {
 public:
  // Occluders that meet the cell are left out, and so are those whose frusta end. `scene`: that holds all that is asked
  // about.
  ShrunkOcclusion(const CellBox& cell, std::span<const ConvexOccluder> occluders, const CellBox& scene,
                  const ShrunkOptions& options);

  // Whether shrunk occluders, some of them together, hide all of the box. Where its rectangle in an image is not
  // covered, that of each half of it is tried, and so on, `halvings` times.
  [[nodiscard]] bool hides(const CellBox& what, int halvings = 6) const;
  // That are drawn.
  [[nodiscard]] std::size_t occluder_count() const noexcept { return occluders_; }

 private:
  struct Image {
    glm::dvec3 from{0.0}, ahead{0.0}, right{0.0}, up{0.0};
    std::vector<double> depths;  // of pixels; infinite where nothing hides
  };
  void draw(Image& image, const ShadowFrustum& frustum) const;
  [[nodiscard]] bool hides(const Image& image, const CellBox& what, int halvings) const;
  [[nodiscard]] bool covers(const Image& image, const CellBox& what) const;

  int resolution_;
  std::vector<Image> images_;
  std::size_t occluders_ = 0;
};

}  // namespace occlod::paper
