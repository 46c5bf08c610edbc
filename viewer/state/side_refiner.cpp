#include "side_refiner.h"

#include <utility>

namespace occlod::viewer {

SideRefiner::SideRefiner(std::span<const RefineObject> objects)
    : objects_(objects.begin(), objects.end()), refiner_(objects), base_triangles_(refiner_->base_triangles()) {}

SideRefiner::SideRefiner(std::span<const RefineObject> objects, const Calibration& calibration, Visibility& backend)
    : objects_(objects.begin(), objects.end()) {
  auto recorded = std::make_unique<RecordedOcclusion>(backend);
  chosen_ = recorded.get();
  std::vector<std::unique_ptr<Visibility>> backends;
  backends.push_back(std::move(recorded));
  chooser_.emplace(objects, calibration, std::move(backends));
  base_triangles_ = chooser_->base_triangles();
}

RecordedOcclusion& SideRefiner::recorded(Occlusion occlusion, Visibility& backend) {
  return chosen_ != nullptr ? *chosen_ : backends_.try_emplace(occlusion, backend).first->second;
}

const Refinement& SideRefiner::refined(const RefineJob& job, Visibility& backend) {
  const View view(job.camera);
  if (chooser_) return job.frame_to_frame ? chooser_->update(view, job.options) : chooser_->refine(view, job.options);
  return job.frame_to_frame ? refiner_->update(view, job.options, backend)
                            : refiner_->refine(view, job.options, backend);
}

void SideRefiner::refine(RefinedSide& side, const RefineJob& job, Occlusion occlusion, Visibility& backend,
                         std::uint64_t number) {
  RecordedOcclusion& recorded = this->recorded(occlusion, backend);
  const bool wants_occluder = job.keep_occluder || job.color_by == ColorBy::outcome;
  std::optional<Asked> asked;
  if (job.frame_to_frame) asked = {job.camera, job.options, occlusion};
  if (!asked || job.again || asked_ != asked) {
    // A frame at rest draws no occluder, so the last one is kept in case it is asked for then.
    if (!job.frame_to_frame || !recorded.keeps()) recorded.begin(wants_occluder || job.frame_to_frame);
    asked_.reset();  // in case this fails
    result_ = &refined(job, recorded);
    if (chooser_) explain_choice();
    asked_ = asked;
    follows_ = std::exchange(number_, number);
    morph(job.options);
  }
  side.refinement = *result_;
  side.explanation = explanation_;
  if (explanation_) side.refinement.stats.refine_ms += explanation_->report.look_ms;
  side.number = number_;
  side.follows = follows_;
  if (wants_occluder) side.occluder = recorded.depth();
}

std::span<const glm::vec3> SideRefiner::positions(std::size_t object) const {
  return morphed_.empty() ? objects_[object].hierarchy->positions() : morphed_[object].positions();
}

void SideRefiner::explain_choice() {
  explanation_ = std::make_shared<Explanation>(Explanation{chooser_->report(), chooser_->calibration()});
}

void SideRefiner::morph(const RefineOptions& options) {
  if (options.geomorph_frames == 0) morphed_.clear();
  if (options.geomorph_frames > 0 && morphed_.empty())
    for (const RefineObject& object : objects_) morphed_.emplace_back(object.hierarchy->positions());
  for (std::size_t i = 0; i < morphed_.size(); ++i) morphed_[i].update(result_->objects[i].geomorphs);
}

}  // namespace occlod::viewer
