#include "occlod/viewcells/cell_builder.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "occlod/core/error.h"
#include "cells/cell_refinement.h"
#include "cells/cell_sampling.h"

namespace occlod {
namespace {

constexpr int most_sampled_eyes = 64;

std::span<const RefineObject> checked(std::span<const RefineObject> objects, const CellOptions& options) {
  if (!(options.tolerance_px > 0.0) || !std::isfinite(options.tolerance_px))
    throw Error({"cell options", "tolerance_px", "is out of its range", "give a number of pixels > 0"});
  if (options.sampled_eyes < 1 || options.sampled_eyes > most_sampled_eyes)
    throw Error({"cell options", "sampled_eyes", "is out of its range", "give 1 to 64 eyes along each axis"});
  if (options.budget > 0 && options.occlusion == CellOcclusion::sampled)
    throw Error({"cell options", "budget", "does not go with sampled occlusion", "give a tolerance only"});
  std::size_t base_triangles = 0;
  for (const RefineObject& object : objects) {
    if (object.hierarchy == nullptr)
      throw Error({"cell builder", "", "an object has no hierarchy", "build one with build_hierarchy()"});
    // Throws for a placement or an eye model that is out of its range, before any cell is built.
    static_cast<void>(CellView({}, options.eyes, object.object_to_world));
    base_triangles += object.hierarchy->base_triangle_count();
  }
  if (options.budget > 0 && options.budget < base_triangles)
    throw Error({"cell options", "budget", "is less than the triangles of the base meshes",
                 fmt::format("give {} or more", base_triangles)});
  return objects;
}

}  // namespace

class CellBuilder::Work {
 public:
  Work(std::span<const RefineObject> objects, const CellOccluders* occluders, const CellOptions& options) {
    if (options.occlusion == CellOcclusion::sampled)
      sampling_.emplace(checked(objects, options), options);
    else
      refinement_.emplace(checked(objects, options), occluders == nullptr ? nullptr : &occluders->surface(),
                          occluders == nullptr ? nullptr : &occluders->boxes(), options, CellRefinement::Without{});
  }
  const CellCut& build(const CellBox& cell) { return sampling_ ? sampling_->build(cell) : refinement_->build(cell); }

 private:
  // One of them.
  std::optional<CellRefinement> refinement_;
  std::optional<CellSampling> sampling_;
};

CellBuilder::CellBuilder(std::span<const RefineObject> objects, const CellOccluders* occluders,
                         const CellOptions& options)
    : work_(std::make_unique<Work>(objects, occluders, options)) {}
CellBuilder::~CellBuilder() = default;
CellBuilder::CellBuilder(CellBuilder&&) noexcept = default;
CellBuilder& CellBuilder::operator=(CellBuilder&&) noexcept = default;

const CellCut& CellBuilder::build(const CellBox& cell) { return work_->build(cell); }

}  // namespace occlod
