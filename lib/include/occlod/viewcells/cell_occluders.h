// What can hide from cells of space, made once for all cells.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "occlod/refine/refiner.h"
#include "occlod/viewcells/cell_view.h"

namespace occlod {

class CellSurface;
class InnerBoxes;

// The surfaces of all objects in world space, simplified. Immutable; copies share their memory, and any number of
// threads may use one.
class CellOccluders {
 public:
  // Of each object the coarsest cut that keeps the topology of the input and whose faces stand for surface that is no
  // farther from them than max_motion (world units, >= 0); with 0 the input itself. A small part of the size of cells
  // is a good choice. Throws Error when a hierarchy is missing or damaged, a placement cannot be inverted, or
  // max_motion is out of its range. O(n log n), some microseconds a split.
  CellOccluders(std::span<const RefineObject> objects, double max_motion);

  // Whether no eye in `eyes` can see any of `what`: every segment between them meets the input. Both sides of every
  // triangle hide, but nothing does within near_reach (world units) of the eyes. Conservative: false where one
  // connected surface does not hide all of it from all of the cell. O(log n + triangles between the two), typically.
  [[nodiscard]] bool hides(const CellBox& eyes, const CellBox& what, double near_reach = 0.0) const;

  // Of all objects.
  [[nodiscard]] std::size_t triangle_count() const noexcept;
  // For the library.
  [[nodiscard]] const CellSurface& surface() const noexcept { return *surface_; }
  // For the library.
  [[nodiscard]] const InnerBoxes& boxes() const noexcept { return *boxes_; }

 private:
  std::shared_ptr<const CellSurface> surface_;
  std::shared_ptr<const InnerBoxes> boxes_;
};

}  // namespace occlod
