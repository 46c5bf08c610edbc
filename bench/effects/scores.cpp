#include "effects/scores.h"

#include <cmath>

#include "base/timing.h"
#include "drawing.h"
#include "support/cpu_clock.h"
#include "visibility/views.h"

namespace occlod::bench {
namespace {

// Nobody sees a tenth of a pixel: what is nearer to the full mesh than that is no better, and an exact picture must not
// make its time worthless.
constexpr double min_error_px = 0.1;

template <typename Values, typename Of>
double geometric_mean(const Values& values, const Of& of) {
  double sum = 0.0;
  for (const auto& value : values) sum += std::log(of(value));
  return std::exp(sum / static_cast<double>(values.size()));
}

}  // namespace

double Scores::frame_ms_mean() const {
  return geometric_mean(frame_ms, [](const std::vector<double>& rounds) { return median(rounds); });
}

double Scores::error_px_mean() const {
  return geometric_mean(error_px,
                        [](const std::vector<double>& rounds) { return std::hypot(median(rounds), min_error_px); });
}

double Scores::score() const { return frame_ms_mean() * error_px_mean(); }

ScoredViews::ScoredViews(const SceneRun& run, int frames) : run_(run) {
  views_.push_back(run.view);
  for (const NamedView& named : path_views(run, frames, std::nullopt)) views_.emplace_back(named.camera);
  full_.reserve(views_.size());
  for (const View& view : views_) full_.emplace_back(run.objects, view);
}

void ScoredViews::draw(std::size_t i, const Refine& refine) {
  drawn_ = tool::draw_objects(run_.objects, refine(views_[i]));
  draw_items(items_, drawn_, views_[i], 1);
}

void ScoredViews::add(std::size_t i, const Refine& refine, Scores& scores, bool may_differ) {
  scores.frame_ms.resize(views_.size());
  scores.error_px.resize(views_.size());
  const double start = thread_cpu_ms();
  draw(i, refine);
  scores.frame_ms[i].push_back(thread_cpu_ms() - start);
  if (may_differ || scores.error_px[i].empty())
    scores.error_px[i].push_back(full_[i].distance_to(items_, drawn_).depth_rms_px);
}

}  // namespace occlod::bench
