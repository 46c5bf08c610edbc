#include "hlod_measurement.h"

#include "base/timing.h"
#include "drawing.h"
#include "stopwatch.h"

namespace occlod::tool {

HlodMeasurement::HlodMeasurement(std::span<const hlod::PlacedHlod> placed, const hlod::TraverseOptions& options)
    : placed_(placed), options_(options), traverser_(placed) {}

void HlodMeasurement::begin() {
  traverse_ms_.clear();
  draw_ms_.clear();
}

void HlodMeasurement::repeat(const View& view) {
  const hlod::Frame& frame = traverser_.draw_frame(view, software_, options_);
  stats_ = frame.stats;
  front_hash_ = frame.front_hash;
  mesh_.assign(front_of(frame), placed_);
  traverse_ms_.push_back(frame.times.cpu_ms - frame.times.gpu_ms);

  const Stopwatch drawing;
  draw_items(items_, mesh_.objects(), view);
  draw_ms_.push_back(drawing.milliseconds());
}

HlodTimes HlodMeasurement::times() const { return {median(traverse_ms_), median(draw_ms_)}; }

}  // namespace occlod::tool
