#include "measurement.h"

#include <algorithm>

#include "drawing.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

// Returns the median of at least one value; for an even number the mean of the middle two.
double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2.0;
}

}  // namespace

Measurement::Measurement(const std::vector<LoadedObject>& objects, Following following)
    : objects_(objects), following_(following), refiner_(refine_objects(objects)) {}

void Measurement::begin() {
  refine_ms_.clear();
  occlusion_ms_.clear();
  draw_ms_.clear();
}

void Measurement::repeat(const View& view, const RefineOptions& options, Visibility& visibility) {
  take(following_ == Following::frame_to_frame ? refiner_.update(view, options, visibility)
                                               : refiner_.refine(view, options, visibility));
  draw(view, options);
}

void Measurement::repeat(const View& view, const RefineOptions& options, AutoRefiner& refiner) {
  take(following_ == Following::frame_to_frame ? refiner.update(view, options) : refiner.refine(view, options));
  refine_ms_.back() += refiner.report().look_ms;
  draw(view, options);
}

void Measurement::take(const Refinement& refinement) {
  refinement_ = &refinement;
  refine_ms_.push_back(refinement.stats.refine_ms);
  occlusion_ms_.push_back(refinement.stats.occlusion_ms);
}

void Measurement::draw(const View& view, const RefineOptions& options) {
  drawn_ = draw_objects(objects_, *refinement_);
  const bool morphs = following_ == Following::frame_to_frame && options.geomorph_frames > 0;
  if (morphs && morphed_.empty())
    for (const DrawObject& object : drawn_) morphed_.emplace_back(object.positions);
  const Stopwatch stopwatch;
  for (std::size_t i = 0; i < morphed_.size(); ++i) {
    morphed_[i].update(refinement_->objects[i].geomorphs);
    drawn_[i].positions = morphed_[i].positions();
  }
  draw_items(items_, drawn_, view, options.threads);
  draw_ms_.push_back(stopwatch.milliseconds());
}

std::size_t Measurement::visible_triangles() const { return count_visible_items(items_, refinement_->stats.triangles); }

RenderTimes Measurement::times() const { return {median(refine_ms_), median(occlusion_ms_), median(draw_ms_)}; }

}  // namespace occlod::tool
