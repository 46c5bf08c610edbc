// Estimates the probability that a node is hidden before any query: Guthe, Balazs and Klein, "Near Optimal Hierarchical
// Culling: Performance Driven Use of Hardware Occlusion Queries" (2006), sec. 3.1. Shares are of the pixels of the
// image, in [0, 1].
#pragma once

namespace occlod::hlod {

// Relates sizes in the world to sizes in the image.
struct ImageScale {
  double focal_length_px = 1.0;  // View::focal_length_px()
  double pixels = 1.0;           // number of pixels of the image, > 0
  bool orthographic = false;     // rays are parallel
};

// Returns c_bb, the share that a box covers: that of a cube with the box's surface area (square world units) whose face
// is `distance` world units from the eye. It is 1 at a distance of 0.
[[nodiscard]] double box_coverage(double box_area, double distance, const ImageScale& image) noexcept;

// Returns R_cov = 3/2 A / A_bb, the ratio of what a mesh covers, taken for a sphere with the mesh's area, to what its
// box covers. The paper describes it as the reciprocal. The ratio exceeds 1 where surfaces lie in several layers, and
// is 1 for a box without area.
[[nodiscard]] double coverage_ratio(double mesh_area, double box_area) noexcept;

// Returns c, the share that the mesh covers. A ratio above 1 counts as 1.
[[nodiscard]] double mesh_coverage(double box_share, double ratio) noexcept;

// Returns c_scr after an object that covers `share` has been drawn as well, at a random place.
[[nodiscard]] double covered_with(double covered, double share) noexcept;

// Names the part of the image in which boxes are taken to lie at random.
enum class CoverModel {
  printed,   // all of it, as published
  in_scene,  // what the boxes of all objects cover: shares are of this part
};

// Returns p_cov, for a box that covers `box_share` behind objects that cover `covered`; 0 if the box covers more.
[[nodiscard]] double cover_probability(double covered, double box_share) noexcept;

// Tells what was known of a node in the last frame.
enum class LastSight {
  visible,
  outside,  // of the frustum, or not reached
  hidden,
};

// Returns p_occl. A visible node has to be hidden for two frames to be worth a query; a hidden node is expected to stay
// hidden.
[[nodiscard]] double occlusion_probability(double cover_probability, LastSight last) noexcept;

}  // namespace occlod::hlod
