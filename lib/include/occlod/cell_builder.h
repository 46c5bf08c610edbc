// What level of detail needs to know about a cell of space: questions about one object for all eyes in the cell at
// once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "occlod/bounds.h"
#include "occlod/refiner.h"
#include "occlod/view.h"

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

// Returns what holds of all eyes that see what this perspective view sees, up to where they are and look. Throws Error
// for an orthographic view.
[[nodiscard]] EyeModel eye_model(const View& view);

// One object's questions, for all eyes of a cell. Immutable. Answers are conservative: they hold for each eye, and
// rounding errs to the side that shows more.
class CellView {
 public:
  // Looks at one object from a cell. Throws Error when the cell is not finite or inverted, a field of `eyes` is out of
  // its range, or `object_to_world` is not finite, not affine or cannot be inverted.
  CellView(const CellBox& cell, const EyeModel& eyes, const glm::dmat4& object_to_world);

  // Returns the pixels that a displacement of one object unit can cover on the screen of any eye, at most, at any point
  // of the sphere (object space) inside the image and beyond the near plane. Finite.
  [[nodiscard]] float largest_scale_px(const Sphere& sphere) const noexcept;
  // Returns the same at any point of the box (object space).
  [[nodiscard]] float largest_scale_px(const Box& box) const noexcept;
  // Returns what largest_scale_px() is at least, at any single point of the box.
  [[nodiscard]] double smallest_scale_px(const Box& box) const noexcept;

  // Returns true only when no eye can see a front face of surface inside `sphere` with normals inside `cone` (object
  // space). The eyes to which all of it shows its back are an intersection of half-spaces: all eyes of a cell are among
  // them iff its corners are, so nothing is lost but rounding.
  [[nodiscard]] bool faces_away(const NormalCone& cone, const Sphere& sphere) const noexcept;
  // Returns true only when no eye sees the front of the triangle (object space).
  [[nodiscard]] bool faces_away(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) const noexcept;

  // Returns the box around the box (object space) grown by `margin` >= 0 (object units) to all sides; rounded outwards.
  [[nodiscard]] CellBox world_box(const Box& box, double margin) const noexcept;

  // Returns the cell as given.
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

// What can hide from cells of space, made once for all cells.

class CellSurface;
class InnerBoxes;

// The surfaces of all objects in world space, simplified. Immutable; copies share their memory, and any number of
// threads may use one.
class CellOccluders {
 public:
  // Takes of each object the coarsest cut that keeps the topology of the input and whose faces stand for surface that
  // is no farther from them than max_motion (world units, >= 0); with 0 the input itself. A small part of the size of
  // cells is a good choice. Throws Error when a hierarchy is missing or damaged, a placement cannot be inverted, or
  // max_motion is out of its range. O(n log n), some microseconds a split.
  CellOccluders(std::span<const RefineObject> objects, double max_motion);

  // Tells whether no eye in `eyes` can see any of `what`: every segment between them meets the input. Both sides of
  // every triangle hide, but nothing does within near_reach (world units) of the eyes. Conservative: false where one
  // connected surface does not hide all of it from all of the cell. O(log n + triangles between the two), typically.
  [[nodiscard]] bool hides(const CellBox& eyes, const CellBox& what, double near_reach = 0.0) const;

  // Counts the triangles of all objects.
  [[nodiscard]] std::size_t triangle_count() const noexcept;
  // Returns the surfaces, for the library.
  [[nodiscard]] const CellSurface& surface() const noexcept { return *surface_; }
  // Returns the boxes inside of solids, for the library.
  [[nodiscard]] const InnerBoxes& boxes() const noexcept { return *boxes_; }

 private:
  std::shared_ptr<const CellSurface> surface_;
  std::shared_ptr<const InnerBoxes> boxes_;
};

// What has to be drawn for all eyes in a cell of space: a level of detail that holds wherever the eye is and looks.

// How what cannot be seen from a cell is found.
enum class CellOcclusion {
  none,     // nothing is hidden
  hull,     // by the occluders: what they hide from all eyes (conservative)
  sampled,  // what no pixel of some eyes shows, nor its neighbours: less is drawn, but what other eyes see may be
            // missing; needs no occluders, and takes much longer
};

// How the cut of a cell is chosen.
struct CellOptions {
  EyeModel eyes = {};                             // what all eyes have in common
  double tolerance_px = 1.0;                      // how far from the input what is seen of it may be drawn, and how far
                                                  // attributes may slip on it where they count, > 0
  CellOcclusion occlusion = CellOcclusion::hull;  // how what is hidden is found
  int sampled_eyes = 5;    // along each axis of the cell, for CellOcclusion::sampled: this to the power of three, >= 1
  std::size_t budget = 0;  // active triangles of all objects, at most; 0: as many as the tolerance takes. Not for
                           // CellOcclusion::sampled
};

// Counts of one call.
struct CellStats {
  std::size_t nodes = 0;            // of the forests, that were looked at
  std::size_t fine_nodes = 0;       // of these, whose subtrees are within the tolerance as they are
  std::size_t hidden_nodes = 0;     // of the others, hidden with their subtrees
  std::size_t fine_splits = 0;      // of what is left, whose own faces are within the tolerance
  std::size_t hidden_splits = 0;    // of what is left, whose own faces are hidden
  std::size_t forced_splits = 0;    // applied because another depends on them, before their own turn
  std::size_t seen_boxes = 0;       // that the middle of the cell sees: they are not asked about
  std::size_t queries = 0;          // whether something else is hidden
  std::size_t queries_hidden = 0;   // of these, answered "hidden"
  std::size_t queries_boxed = 0;    // of these, as something solid that holds a large box is before them
  std::size_t floods = 0;           // of the surface that hides, to answer them
  std::size_t flood_triangles = 0;  // that floods reached
};

// The cut of one object.
struct CellObjectCut {
  std::vector<SplitId> applied;     // ascending, closed under dependency
  std::vector<Triangle> triangles;  // to draw: active faces, but for those whose front no eye can see; base faces
                                    // first, then by split and slot; ids of the hierarchy's wedges
};

// What build() gives; valid until its next call.
struct CellCut {
  std::vector<CellObjectCut> objects;  // as given to the builder
  std::size_t triangles = 0;           // active, of all objects
  std::size_t drawn_triangles = 0;     // of these, to draw
  double error_px = 0.0;               // how far anything seen is from what is drawn, at most, or attributes slip
                                       // if that is more: the tolerance or less, or what a budget left
  CellStats stats;                     // of the call
};

// Chooses cuts for cells. Reuses its memory; one thread each. A cell's cut depends on nothing but the cell, the
// objects, the occluders and the options.
//
// *What is promised.* For every eye in the cell and every direction, each point of the input whose front is seen beyond
// the near plane is within the tolerance (with a budget: within error_px), on the screen, of a face that is drawn, or
// of one that is not because it turns its back on the whole cell. Components of the input that are smaller than the
// tolerance may be gone. Both sides of the input's triangles hide, and backs of objects that are not two-sided are
// never seen. It is proven for hierarchies with ErrorBound::accumulated (see cell_refinement.h); measured bounds
// promise for a cut as a whole. Nothing is promised for CellOcclusion::sampled.
//
// Where an object's attributes count (RefineObject::attributes) no split is left out whose Hierarchy::attribute_error()
// is more than the tolerance at anything seen: about a root mean square of how far textures slip, no bound.
//
// With a budget, splits are made in the order of the error below them, the largest first, until one does not fit.
class CellBuilder {
 public:
  // Chooses by these occluders; without any, CellOcclusion::hull hides nothing. Hierarchies and occluders outlive the
  // builder; `occluders` are of the same objects. Throws Error when a hierarchy is missing or damaged, a placement
  // cannot be inverted, or an option is out of its range: a budget below the triangles of the base meshes is.
  CellBuilder(std::span<const RefineObject> objects, const CellOccluders* occluders, const CellOptions& options);
  ~CellBuilder();
  CellBuilder(CellBuilder&&) noexcept;
  CellBuilder& operator=(CellBuilder&&) noexcept;

  // Chooses the cut of a cell. Throws Error when the cell is not finite or inverted.
  const CellCut& build(const CellBox& cell);

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

// How space is divided into view cells, and how their cuts are chosen.

// When a cell is divided that draws more than CellTreeOptions::max_triangles.
enum class CellDivision : std::uint32_t {
  halving,  // as in Chhugani and others 2003: if one of its parts, at least, draws less than half of what it draws
  gain      // if its parts draw, on average by volume, less than nine tenths of what it draws
};

// All that decides what is in a .vlod file, besides the objects. Root cells are divided ten times at most.
struct CellTreeOptions {
  CellOptions cell = {};  // of each cell
  // The eye may be anywhere in these boxes, world space. Each is divided by itself; they may overlap.
  std::vector<CellBox> regions = {};
  double root_cell = 16.0;     // world units, > 0: a region is cut into equal boxes whose edges are no longer
  double smallest_cell = 1.0;  // world units, > 0: no edge is halved that would become shorter
  std::uint64_t max_triangles = 200'000;          // to draw: a cell that draws more is divided if `division` says so
  CellDivision division = CellDivision::halving;  // whether that is worth while
  // How far occluders may have moved, world units, >= 0; a quarter of smallest_cell unless it is given. See
  // CellOccluders. Unused where nothing is hidden.
  std::optional<double> occluder_motion = {};
};

}  // namespace occlod
