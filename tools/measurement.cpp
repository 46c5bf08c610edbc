#include "measurement.h"

#include <algorithm>

#include "drawing.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

// Of at least one value; the mean of the two in the middle of an even number.
double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2.0;
}

}  // namespace

Measurement::Measurement(const std::vector<LoadedObject>& objects)
    : objects_(objects), refiner_(refine_objects(objects)) {}

void Measurement::begin() {
  refine_ms_.clear();
  occlusion_ms_.clear();
  draw_ms_.clear();
}

void Measurement::repeat(const View& view, const RefineOptions& options, Visibility& visibility) {
  draw(view, refiner_.refine(view, options, visibility));
}

void Measurement::repeat(const View& view, const RefineOptions& options, AutoRefiner& refiner) {
  draw(view, refiner.refine(view, options));
  refine_ms_.back() += refiner.report().look_ms;
}

void Measurement::advance(const View& view, const RefineOptions& options, Visibility& visibility) {
  draw(view, refiner_.update(view, options, visibility));
}

void Measurement::draw(const View& view, const Refinement& refinement) {
  refinement_ = &refinement;
  drawn_ = draw_objects(objects_, *refinement_);
  const Stopwatch stopwatch;
  redraw(items_, drawn_, view);
  draw_ms_.push_back(stopwatch.milliseconds());
  refine_ms_.push_back(refinement_->stats.refine_ms);
  occlusion_ms_.push_back(refinement_->stats.occlusion_ms);
}

std::size_t Measurement::visible_triangles() const { return count_visible_items(items_, refinement_->stats.triangles); }

RenderTimes Measurement::times() const { return {median(refine_ms_), median(occlusion_ms_), median(draw_ms_)}; }

}  // namespace occlod::tool
