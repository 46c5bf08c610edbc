#include "occlod/viewcells/cell_occluders.h"

#include <cmath>

#include "occlod/core/error.h"
#include "base/placement.h"
#include "cells/hull_test.h"
#include "cells/inner_boxes.h"

namespace occlod {
namespace {

std::shared_ptr<const CellSurface> surface_of(std::span<const RefineObject> objects, double max_motion) {
  if (!(max_motion >= 0.0) || !std::isfinite(max_motion))
    throw Error({"cell occluders", "max_motion", "is out of its range", "give a length >= 0, in world units"});
  for (const RefineObject& object : objects) {
    if (object.hierarchy == nullptr)
      throw Error({"cell occluders", "", "an object has no hierarchy", "build one with build_hierarchy()"});
    require_placement(object.object_to_world);
  }
  return std::make_shared<const CellSurface>(objects, max_motion, CellSurface::Without{});
}

}  // namespace

CellOccluders::CellOccluders(std::span<const RefineObject> objects, double max_motion)
    : surface_(surface_of(objects, max_motion)), boxes_(std::make_shared<const InnerBoxes>(*surface_)) {}

bool CellOccluders::hides(const CellBox& eyes, const CellBox& what, double near_reach) const {
  HullTest test(*surface_, boxes_.get());
  test.set_cell(eyes, near_reach);
  return test.hides(what);
}

std::size_t CellOccluders::triangle_count() const noexcept { return surface_->triangle_count(); }

}  // namespace occlod
