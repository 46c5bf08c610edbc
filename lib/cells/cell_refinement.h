// Tests which boxes are visible from the centre of a cell: the cheapest proof that a box is not hidden.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "cells/cell_surface.h"
#include "cells/hull_test.h"
#include "occlod/cell_builder.h"
#include "occlod/mesh.h"
#include "raster/depth_image.h"
#include "refine/cut.h"

namespace occlod {

// Renders depth images of a surface in all six directions. Reuses its memory, 25 MB; each thread needs its own.
class CellImages {
 public:
  // Pixels along each side of an image, a multiple of the tile size. Half as many leave a third more boxes to the hull
  // test where triangles are small; twice as many take longer to draw than they save.
  static constexpr int size = 1024;

  // The surface must outlive this object.
  explicit CellImages(const CellSurface& surface);

  // Draws from the centre of the cell. Triangles that come within `near_reach` (world units) of the cell are left out,
  // as they hide nothing. Typically O(visible triangles).
  void draw(const CellBox& cell, double near_reach);

  // Returns whether a ray through the centre of a pixel enters the box before it meets the surface: up to rounding, no
  // set of triangles hides the box then. Triangles that touch the box can hide it here, though not in the hull test, so
  // false proves nothing. O(pixels of the box), usually less.
  [[nodiscard]] bool show(const CellBox& what);

 private:
  static constexpr int tile_size = 16;  // in pixels
  static constexpr int tiles = size / tile_size;
  static constexpr int stride = size + tile_size;  // see DepthImage

  // Describes one direction from the eye. In its space the third axis points away from the eye.
  struct Side {
    int axis = 0;                      // world axis that is the third axis
    double sign = 1.0;                 // its direction
    std::vector<float> nearness;       // see DepthBuffer
    std::vector<float> farthest;       // per tile: nearness of the farthest pixel
    std::vector<bool> farthest_known;  // per tile; false where something has been drawn since
  };
  // Describes the image of a box on one side, and the pixels that it may cover.
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
  std::vector<glm::vec3> positions_;  // of a group, relative to the eye
  std::vector<Triangle> triangles_;
};

// Computes the cuts of all objects for one cell.
//
// Walks the forests from their roots. A subtree is skipped if its error is within the tolerance for every eye, or if
// its box, grown by g, is hidden from the cell. Otherwise its children are visited; and if the faces of its own split
// are not within the tolerance and their box, grown by g, is not hidden, the split is applied with all splits on which
// it depends. g(box) is the smaller of the subtree's guaranteed error and the length that covers the tolerance at the
// point of the box where it is largest (all in object units). With a budget, g is the error alone, because the
// tolerance that is reached in the end is not known in advance: nodes are visited in the order of their error on the
// screen, and where a split does not fit, all remaining nodes have at most the error of that node.
//
// *Why this keeps the promise.* Let an eye in the cell see a point x of the input. Follow x through the collapses: one
// that ends its face moves it to a point of a face that it makes. Let t_1, ..., t_k be the splits of these collapses
// from coarse to fine, f_j the face with x that t_j inserts, and x_j the position of x there; f_0 is in the base mesh,
// or does not exist because the component of x vanishes. t_(j+1) removes f_j, so it depends on t_j and is applied only
// with it, and |x - x_j| <= error(t_(j+1)). Call t_j fine if it, its own faces or a subtree that contains it is within
// the tolerance. The bounds of all of these contain f_(j-1), which t_j removes, and errors are saturated. So if t_j is
// fine, x is within the tolerance of x_(j-1), as measured at x_(j-1), and closer than any error of a split before t_j.
//   Let t_j be the last that is not fine; if there is none, x is within the tolerance wherever it is in the cut, or its
// component is smaller than the tolerance. x is no farther from x_j than error(t_j), and, if j < k, than the tolerance
// at x_j. (If j = k, x = x_j.) So it is no farther than the g of any box that contains f_j: that of t_j's own faces and
// those of all subtrees that contain t_j. Grown by g, these boxes contain x, which is visible, so they are not hidden.
// So t_j is reached and applied, and t_1, ..., t_(j-1) with it. Then x is in the cut on some f_i, i >= j, and within
// the tolerance of it. The box of f_i, grown by its own g, contains x as well; so f_i is not left out as hidden.
//
// *Attributes.* Where attributes count, the error that must be within the tolerance is the larger of the guaranteed
// error and the attribute error. A split that is fine in that sense is fine in the sense above, so the proof holds. A
// visible point x is then in the cut on a face f_i, and all splits on its path after t_i are fine: its texel has been
// displaced by no more than the tolerance since then, as far as Hierarchy::attribute_error() tells. Boxes are grown by
// the guaranteed error only, because displaced texels move no surface.
//
// *Asking less.* Of two boxes, one in the other, the larger is not hidden if the smaller is not. So what is far below
// is asked about before what is above it, a single face before several, and splits after those that may force them.
// What the middle of the cell does not see, it does not see a part of. A box that is not asked about counts as not
// hidden, so none of this can hide more.
//
// Which faces turn away decides only what is drawn, never what is refined: the input may face an eye where a coarse
// version of it does not.
class CellRefinement {
 public:
  // Without `surface` nothing is hidden. `boxes` are those of the surface, or null.
  CellRefinement(std::span<const RefineObject> objects, const CellSurface* surface, const InnerBoxes* boxes,
                 const CellOptions& options);

  const CellCut& build(const CellBox& cell);

 private:
  // Describes a node to visit.
  struct Candidate {
    float px = 0.0F;  // its error on the screen, see error_of()
    std::uint32_t object = 0;
    SplitId split = 0;

    // Orders the heap: smaller candidates are visited later.
    friend bool operator<(const Candidate& a, const Candidate& b) {
      return std::tie(a.px, b.object, b.split) < std::tie(b.px, a.object, a.split);
    }
  };
  struct Face {
    CellBox box;              // grown by g
    std::uint32_t place = 0;  // index in active_
  };

  // What is known about a node before it is asked about, or after.
  enum class Sight : std::uint8_t {
    unknown,   // the middle of the cell may see it
    unseen,    // the middle does not see it, as it does not see a node above
    doubtful,  // unseen, and the last node of its chain is hidden; see next_below()
    shown,     // unseen, and not hidden, as that node is not
    hidden
  };
  struct Visit {
    SplitId split = 0;
    Sight sight = Sight::unknown;
    bool is_last = false;  // whether all nodes below have been visited
    Box box;               // around the subtree: what the boxes of the node and of those above have in common
  };

  // Visits splits after those below them, which often force them.
  void refine(std::uint32_t object, const CellView& view);
  void visit(std::uint32_t object, const CellView& view, const Visit& entry);
  [[nodiscard]] Sight sight_of(std::uint32_t object, const CellView& view, const Visit& entry, SplitId next);
  // Returns the first child that is not within the tolerance, or none. Such a child, its own such child and so on are
  // the chain of a node.
  [[nodiscard]] SplitId next_below(std::uint32_t object, const CellView& view, SplitId s) const;
  void refine_to_budget();
  void visit_by_error(std::uint32_t object, const CellView& view, SplitId s);
  void try_split(std::uint32_t object, const CellView& view, SplitId s, bool may_be_seen);
  void find_drawn(std::uint32_t object, const CellView& view);
  // Adds a face: it is drawn unless it faces away from the cell; unless the centre of the cell sees it, drop_hidden()
  // decides.
  void add_face(std::uint32_t object, const CellView& view, const FaceRef& ref, const Triangle& t, std::uint32_t place);
  static void sort_by_place(std::span<Face> faces);
  void drop_hidden(std::span<const Face> faces, bool is_first_hidden);
  [[nodiscard]] static CellBox box_around(std::span<const Face> faces);
  [[nodiscard]] CellBox grown_box(const CellView& view, const Box& box, float error) const;
  // Returns whether the box is visible from the centre of the cell, in front of everything that hides.
  [[nodiscard]] bool is_seen(const CellBox& what);
  [[nodiscard]] bool is_hidden(const CellBox& what);
  // Returns the same of a box that the middle of the cell does not see.
  [[nodiscard]] bool is_blocked(const CellBox& what);
  [[nodiscard]] bool is_hidden(const CellView& view, const Box& box, float error, bool may_be_seen);
  // Returns the error that must be within the tolerance: the guaranteed error, or the attribute error where that is
  // larger.
  [[nodiscard]] float error_of(std::uint32_t object, SplitId s) const;
  // Returns whether the error, at this many pixels per unit, is within the tolerance; if so, it counts towards the
  // cell's error.
  [[nodiscard]] bool is_fine(float error, float scale_px);

  std::vector<RefineObject> objects_;
  CellOptions options_;
  std::vector<Cut> cuts_;
  std::vector<CellView> views_;  // per object
  std::size_t triangles_ = 0;    // number of active triangles
  bool is_full_ = false;         // whether a split did not fit into the budget
  std::optional<HullTest> hull_test_;
  std::optional<CellImages> images_;
  std::vector<Visit> visits_;     // nodes to visit, of one object
  std::vector<SplitId> stack_;    // children of a node, with a budget
  std::vector<Candidate> heap_;   // nodes to visit, of all objects, with a budget
  std::vector<Triangle> active_;  // by wedges
  std::vector<bool> drawn_;       // per entry of active_
  std::vector<Face> faces_;
  CellCut result_;
};

}  // namespace occlod
