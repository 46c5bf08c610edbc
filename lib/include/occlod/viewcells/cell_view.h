// What level of detail needs to know about a cell of space: questions about one object for all eyes in the cell at
// once.
#pragma once

#include <array>
#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "occlod/math/bounds.h"
#include "occlod/view/view.h"

namespace occlod {

// A closed axis-aligned box in world space, in which the eye may be anywhere and look anywhere; may be flat or a point.
struct CellBox {
  glm::dvec3 min{0.0};  // world space
  glm::dvec3 max{0.0};  // min <= max in every axis
  friend bool operator==(const CellBox&, const CellBox&) = default;
};

// What is the same for all eyes of a cell. The defaults: 1024x768 pixels, 60 degrees from top to bottom.
struct EyeModel {
  double focal_length_px = 665.1;    // pixels that one world unit covers at distance 1, > 0; the largest of all eyes
  double cos_corner_angle = 0.7206;  // of the angle between the line of sight and the corners of the image, in (0, 1];
                                     // the smallest of all eyes
  double near = 0.01;                // distance to the near plane, world units, > 0; what it clips away hides nothing
  double clearance = 0.0;            // no eye comes nearer than this to any surface, world units, >= 0
  friend bool operator==(const EyeModel&, const EyeModel&) = default;
};

// Of all eyes that see what this perspective view sees, up to where they are and look. Throws Error for an orthographic
// view.
[[nodiscard]] EyeModel eye_model(const View& view);

// One object's questions, for all eyes of a cell. Immutable. Answers are conservative: they hold for each eye, and
// rounding errs to the side that shows more.
class CellView {
 public:
  // Throws Error when the cell is not finite or inverted, a field of `eyes` is out of its range, or `object_to_world`
  // is not finite, not affine or cannot be inverted.
  CellView(const CellBox& cell, const EyeModel& eyes, const glm::dmat4& object_to_world);

  // Pixels that a displacement of one object unit can cover on the screen of any eye, at most, at any point of the
  // sphere (object space) inside the image and beyond the near plane. Finite.
  [[nodiscard]] float largest_scale_px(const Sphere& sphere) const noexcept;
  // The same at any point of the box (object space).
  [[nodiscard]] float largest_scale_px(const Box& box) const noexcept;
  // What largest_scale_px() is at least, at any single point of the box.
  [[nodiscard]] double smallest_scale_px(const Box& box) const noexcept;

  // True only when no eye can see a front face of surface inside `sphere` with normals inside `cone` (object space).
  // The eyes to which all of it shows its back are an intersection of half-spaces: all eyes of a cell are among them
  // iff its corners are, so nothing is lost but rounding.
  [[nodiscard]] bool faces_away(const NormalCone& cone, const Sphere& sphere) const noexcept;
  // True only when no eye sees the front of the triangle (object space).
  [[nodiscard]] bool faces_away(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) const noexcept;

  // Around the box (object space) grown by `margin` >= 0 (object units) to all sides; rounded outwards.
  [[nodiscard]] CellBox world_box(const Box& box, double margin) const noexcept;

  // As given.
  [[nodiscard]] const CellBox& cell() const noexcept { return cell_; }

 private:
  [[nodiscard]] double scale_px_at(double distance) const noexcept;

  CellBox cell_;
  EyeModel eyes_;
  glm::dmat4x3 object_to_world_;
  double largest_stretch_ = 1.0;              // world units per object unit
  double scale_at_near_px_ = 0.0;             // per object unit
  std::array<glm::dvec3, 8> corners_;         // of the cell, object space
  std::array<glm::vec3, 8> rounded_corners_;  // to single precision
  double corner_slack_ = 0.0;                 // how far corners_ may be off, object units
};

}  // namespace occlod
