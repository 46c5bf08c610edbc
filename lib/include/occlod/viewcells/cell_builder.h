// What has to be drawn for all eyes in a cell of space: a level of detail that holds wherever the eye is and looks.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "occlod/refine/refiner.h"
#include "occlod/viewcells/cell_occluders.h"
#include "occlod/viewcells/cell_view.h"

namespace occlod {

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
  // Without occluders CellOcclusion::hull hides nothing. Hierarchies and occluders outlive the builder; `occluders` are
  // of the same objects. Throws Error when a hierarchy is missing or damaged, a placement cannot be inverted, or an
  // option is out of its range: a budget below the triangles of the base meshes is.
  CellBuilder(std::span<const RefineObject> objects, const CellOccluders* occluders, const CellOptions& options);
  ~CellBuilder();
  CellBuilder(CellBuilder&&) noexcept;
  CellBuilder& operator=(CellBuilder&&) noexcept;

  // Throws Error when the cell is not finite or inverted.
  const CellCut& build(const CellBox& cell);

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace occlod
