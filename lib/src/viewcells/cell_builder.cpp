#include "occlod/viewcells/cell_builder.h"

#include <cmath>

#include "occlod/core/error.h"
#include "viewcells/cell_refinement.h"

namespace occlod {
namespace {

std::span<const RefineObject> checked(std::span<const RefineObject> objects, const CellOptions& options) {
  if (!(options.tolerance_px > 0.0) || !std::isfinite(options.tolerance_px))
    throw Error({"cell options", "tolerance_px", "is out of its range", "give a number of pixels > 0"});
  for (const RefineObject& object : objects) {
    if (object.hierarchy == nullptr)
      throw Error({"cell builder", "", "an object has no hierarchy", "build one with build_hierarchy()"});
    // Throws for a placement or an eye model that is out of its range, before any cell is built.
    static_cast<void>(CellView({}, options.eyes, object.object_to_world));
  }
  return objects;
}

}  // namespace

class CellBuilder::Work {
 public:
  Work(std::span<const RefineObject> objects, const CellOccluders* occluders, const CellOptions& options)
      : refinement_(checked(objects, options), occluders == nullptr ? nullptr : &occluders->surface(), options, {}) {}
  const CellCut& build(const CellBox& cell) { return refinement_.build(cell); }

 private:
  CellRefinement refinement_;
};

CellBuilder::CellBuilder(std::span<const RefineObject> objects, const CellOccluders* occluders,
                         const CellOptions& options)
    : work_(std::make_unique<Work>(objects, occluders, options)) {}
CellBuilder::~CellBuilder() = default;
CellBuilder::CellBuilder(CellBuilder&&) noexcept = default;
CellBuilder& CellBuilder::operator=(CellBuilder&&) noexcept = default;

const CellCut& CellBuilder::build(const CellBox& cell) { return work_->build(cell); }

}  // namespace occlod
