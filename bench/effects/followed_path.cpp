#include "effects/followed_path.h"

#include <algorithm>

#include "drawing.h"
#include "support/cpu_clock.h"

namespace occlod::bench {
namespace {

constexpr int whole_path = 120;
constexpr std::size_t first_compared = 15;  // until then choices settle
constexpr std::size_t compared_step = 9;

}  // namespace

FollowedPath::FollowedPath(const SceneRun& run, const CameraPath& path, int frames) : run_(run) {
  for (int i = 0; i < frames; ++i)
    views_.emplace_back(camera_at(path, std::min(i * std::max(1, path.frames / whole_path), path.frames - 1)));
  for (std::size_t i = first_compared; i < views_.size(); i += compared_step) compared_.push_back(i);
  full_.reserve(compared_.size());
  for (const std::size_t i : compared_) full_.emplace_back(run.objects, views_[i]);
}

void FollowedPath::follow(const Refine& refine, Scores& scores) {
  scores.frame_ms.resize(views_.size() - first_compared);
  const bool compares = scores.error_px.empty();
  std::size_t next = 0;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const double start = thread_cpu_ms();
    drawn_ = tool::draw_objects(run_.objects, refine(views_[i]));
    draw_items(items_, drawn_, views_[i], 1);
    if (i >= first_compared) scores.frame_ms[i - first_compared].push_back(thread_cpu_ms() - start);
    if (!compares || next == compared_.size() || compared_[next] != i) continue;
    scores.error_px.push_back({full_[next++].distance_to(items_, drawn_).depth_rms_px});
  }
}

}  // namespace occlod::bench
