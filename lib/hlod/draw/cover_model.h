// How probable it is that a node is hidden before anybody has asked: Guthe, Balazs and Klein, "Near Optimal
// Hierarchical Culling: Performance Driven Use of Hardware Occlusion Queries" (2006), sec. 3.1. Shares are of the
// pixels of the image, in [0, 1].
#pragma once

namespace occlod::hlod {

// How large things look.
struct ImageScale {
  double focal_length_px = 1.0;  // View::focal_length_px()
  double pixels = 1.0;           // of the image, > 0
  bool orthographic = false;     // rays are parallel
};

// c_bb: the share that a box covers, reckoned as a cube with its surface area (square world units) whose face is at
// `distance` from the eye (world units). 1 at a distance of 0.
[[nodiscard]] double box_coverage(double box_area, double distance, const ImageScale& image) noexcept;

// R_cov = 3/2 A / A_bb: what a mesh covers of what its box covers, reckoned as a sphere with the mesh's area. The paper
// words it as the reciprocal. Above 1 where surface lies in several layers. 1 for a box without area.
[[nodiscard]] double coverage_ratio(double mesh_area, double box_area) noexcept;

// c: the share that the mesh covers; a ratio above 1 counts as 1.
[[nodiscard]] double mesh_coverage(double box_share, double ratio) noexcept;

// c_scr after something with this coverage has been drawn as well, placed at random.
[[nodiscard]] double covered_with(double covered, double share) noexcept;

// How probable it is that all of a box is covered, for squares placed at random.
enum class CoverModel {
  printed,    // (sqrt c_scr - sqrt c_bb)^2: boxes may stick out of the image
  corrected,  // ((sqrt c_scr - sqrt c_bb) / (1 - sqrt c_bb))^2: they lie inside it
};

// p_cov: of a box that covers `box_share` behind what covers `covered`. 0 where the box is the larger.
[[nodiscard]] double cover_probability(double covered, double box_share, CoverModel model) noexcept;

// What was known of a node in the last frame.
enum class LastSight {
  visible,
  outside,  // of the frustum, or not reached
  hidden,
};

// p_occl, from p_cov: what was visible has to be hidden for two frames to be worth a query; what was hidden stays so.
[[nodiscard]] double occlusion_probability(double cover_probability, LastSight last) noexcept;

}  // namespace occlod::hlod
