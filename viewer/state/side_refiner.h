// Refines one side of the picture, from scratch or from frame to frame.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "occlod/refine/geomorph.h"
#include "occlod/refine/refiner.h"
#include "recorded_occlusion.h"
#include "refine_worker.h"

namespace occlod::viewer {

class SideRefiner {
 public:
  explicit SideRefiner(std::span<const RefineObject> objects);

  [[nodiscard]] std::size_t base_triangles() const noexcept { return refiner_.base_triangles(); }

  // Fills the refinement, its numbers and, when the job asks for it, the occluder. From frame to frame a job that asks
  // for the same mesh as the one before, and not for another frame of it, gets that mesh. `number`: ascending over all
  // refinements of all SideRefiners. `backend` outlives this.
  void refine(RefinedSide& side, const RefineJob& job, Occlusion occlusion, Visibility& backend, std::uint64_t number);

  // Of one object's vertices as the last mesh is drawn.
  [[nodiscard]] std::span<const glm::vec3> positions(std::size_t object) const;

 private:
  struct Asked {
    Camera camera;
    RefineOptions options;
    Occlusion occlusion = Occlusion::none;
    friend bool operator==(const Asked&, const Asked&) = default;
  };
  void morph(const RefineOptions& options);

  std::vector<RefineObject> objects_;
  Refiner refiner_;
  // Refinement from frame to frame tells backends apart by where they are.
  std::map<Occlusion, RecordedOcclusion> backends_;
  const Refinement* result_ = nullptr;
  std::uint64_t number_ = 0;               // of result_
  std::uint64_t follows_ = 0;              // the one before it
  std::optional<Asked> asked_;             // from frame to frame
  std::vector<MorphedPositions> morphed_;  // of each object, while vertices may slide
};

}  // namespace occlod::viewer
