#include "side_refiner.h"

#include <utility>

namespace occlod::viewer {

SideRefiner::SideRefiner(std::span<const RefineObject> objects)
    : objects_(objects.begin(), objects.end()), refiner_(objects) {}

void SideRefiner::refine(RefinedSide& side, const RefineJob& job, Occlusion occlusion, Visibility& backend,
                         std::uint64_t number) {
  RecordedOcclusion& recorded = backends_.try_emplace(occlusion, backend).first->second;
  const bool wants_occluder = job.keep_occluder || job.color_by == ColorBy::outcome;
  const View view(job.camera);
  std::optional<Asked> asked;
  if (job.frame_to_frame) asked = {job.camera, job.options, occlusion};
  if (!asked || job.again || asked_ != asked) {
    // A frame at rest draws no occluder: the last one is kept in case that it is asked for then.
    if (!job.frame_to_frame || !recorded.keeps()) recorded.begin(wants_occluder || job.frame_to_frame);
    asked_.reset();  // should this fail
    result_ = job.frame_to_frame ? &refiner_.update(view, job.options, recorded)
                                 : &refiner_.refine(view, job.options, recorded);
    asked_ = asked;
    follows_ = std::exchange(number_, number);
    morph(job.options);
  }
  side.refinement = *result_;
  side.number = number_;
  side.follows = follows_;
  if (wants_occluder) side.occluder = recorded.depth();
}

std::span<const glm::vec3> SideRefiner::positions(std::size_t object) const {
  return morphed_.empty() ? objects_[object].hierarchy->positions() : morphed_[object].positions();
}

void SideRefiner::morph(const RefineOptions& options) {
  if (options.geomorph_frames == 0) morphed_.clear();
  if (options.geomorph_frames > 0 && morphed_.empty())
    for (const RefineObject& object : objects_) morphed_.emplace_back(object.hierarchy->positions());
  for (std::size_t i = 0; i < morphed_.size(); ++i) morphed_[i].update(result_->objects[i].geomorphs);
}

}  // namespace occlod::viewer
