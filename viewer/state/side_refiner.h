// Refines one side of the picture, from scratch or from frame to frame.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "occlod/auto_refiner.h"
#include "occlod/refiner.h"
#include "recorded_occlusion.h"
#include "refine_worker.h"

namespace occlod::viewer {

class SideRefiner {
 public:
  explicit SideRefiner(std::span<const RefineObject> objects);
  // This is only for Occlusion::automatic. It uses `backend`, which must outlive this object.
  SideRefiner(std::span<const RefineObject> objects, const Calibration& calibration, Visibility& backend);

  [[nodiscard]] std::size_t base_triangles() const noexcept { return base_triangles_; }

  // Fills the refinement, its numbers and, if the job asks for it, the occluder. From frame to frame, a job that asks
  // for the same mesh as the last one, and not for one more frame of it, gets that mesh. `number` ascends over all
  // refinements of all SideRefiners. `backend` must outlive this object.
  void refine(RefinedSide& side, const RefineJob& job, Occlusion occlusion, Visibility& backend, std::uint64_t number);

  // Returns the positions of one object's vertices as the last mesh is drawn.
  [[nodiscard]] std::span<const glm::vec3> positions(std::size_t object) const;
  // See Refiner::visibility_ages().
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::size_t object) const {
    return chooser_ ? chooser_->visibility_ages(object) : refiner_->visibility_ages(object);
  }

 private:
  struct Asked {
    Camera camera;
    RefineOptions options;
    Occlusion occlusion = Occlusion::none;
    friend bool operator==(const Asked&, const Asked&) = default;
  };
  [[nodiscard]] RecordedOcclusion& recorded(Occlusion occlusion, Visibility& backend);
  [[nodiscard]] const Refinement& refined(const RefineJob& job, Visibility& backend);
  void explain_choice();
  void morph(const RefineOptions& options);

  std::vector<RefineObject> objects_;
  std::optional<Refiner> refiner_;  // either this or the chooser is set
  std::optional<AutoRefiner> chooser_;
  RecordedOcclusion* chosen_ = nullptr;  // the chooser's
  std::size_t base_triangles_ = 0;
  // Refinement from frame to frame identifies backends by address, which a map keeps.
  std::map<Occlusion, RecordedOcclusion> backends_;
  const Refinement* result_ = nullptr;
  std::shared_ptr<const Explanation> explanation_;  // of result_
  std::uint64_t number_ = 0;                        // of result_
  std::uint64_t follows_ = 0;                       // the previous number
  std::optional<Asked> asked_;                      // from frame to frame
  std::vector<MorphedPositions> morphed_;           // per object, while vertices may morph
};

}  // namespace occlod::viewer
