#include "report/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <limits>
#include <map>
#include <utility>

#include "accuracy.h"
#include "occlod/base.h"
#include "refine/tuning.h"
#include "report/setting_run.h"
#include "visibility/views.h"

namespace occlod::bench {
namespace {

// Wrongly hidden pixels of one view, counted once for all settings that hide the same; they are counted in refinements
// from scratch, so there is nothing to tell of settings that go from frame to frame.
class HiddenCounts {
 public:
  HiddenCounts(const std::vector<LoadedObject>& objects, const View& view) : counter_(objects), view_(view) {}

  double of(const Setting& setting) {
    if (setting.frame_to_frame) return std::numeric_limits<double>::quiet_NaN();
    const auto [found, is_new] = counts_.try_emplace(what_hides(setting), 0.0);
    if (!is_new || !setting.occlusion) return found->second;
    if (!culling_ || *culling_ != tuning_of(setting.refine).culling) counter_.set_view(view_, setting.refine);
    culling_ = tuning_of(setting.refine).culling;
    found->second = static_cast<double>(counter_.count(setting.refine, *make_visibility(setting)));
    return found->second;
  }

 private:
  tool::WronglyHidden counter_;
  const View& view_;
  std::optional<Culling> culling_;  // of what counts are compared with
  std::map<std::string, double> counts_;
};

void look(std::deque<SettingRun>& runs, const std::vector<LoadedObject>& objects, const Camera& camera,
          const SweepOptions& options) {
  const View view(camera);
  const tool::FullMeshPicture full(objects, view);
  const View hidden_view(sized(camera, options.hidden_size));
  HiddenCounts hidden(objects, hidden_view);
  for (SettingRun& run : runs) {
    run.next(view, full);
    run.set_wrongly_hidden(hidden.of(run.setting()));
  }
}

double geometric_mean(const std::vector<SceneOutcomes>& scenes, std::size_t setting, double Outcome::*time) {
  double sum = 0.0;
  for (const SceneOutcomes& scene : scenes) sum += std::log(std::max(scene.outcomes[setting].*time, 1e-3));
  return std::exp(sum / static_cast<double>(scenes.size()));
}

}  // namespace

Burst burst_of(const SceneRun& run, const std::string& path_name, int i, const SweepOptions& options) {
  const auto found = run.description.paths.find(path_name);
  if (found == run.description.paths.end())
    throw Error({run.description.name, "/paths", fmt::format("has no \"{}\"", path_name), "name a path of the scene"});
  const CameraPath& path = found->second;
  const int length = std::min(options.burst_frames, path.frames);
  const int middle = (2 * i + 1) * path.frames / (2 * options.bursts);
  const int first = std::clamp(middle - length / 2, 0, path.frames - length);
  Burst burst{{}, first + length - 1};
  for (int k = 0; k < length; ++k) burst.cameras.push_back(sized(camera_at(path, first + k), options.size));
  return burst;
}

SceneOutcomes sweep_scene(SceneRun& run, const std::string& path, const std::vector<Setting>& settings,
                          const SweepOptions& options) {
  SceneOutcomes result{run.description.name, path, run.full_triangles(), {}, {}, {}};
  std::deque<SettingRun> runs;
  for (const Setting& setting : settings) runs.emplace_back(setting, run.objects);
  for (int i = 0; i < options.bursts; ++i) {
    const auto [cameras, last_frame] = burst_of(run, path, i, options);
    fmt::print(stderr, "{}, {}: {} of {}\n", run.description.name, path, i + 1, options.bursts);
    for (SettingRun& r : runs) r.start(View(cameras.front()));
    for (std::size_t k = 1; k + 1 < cameras.size(); ++k)
      for (SettingRun& r : runs) r.next(View(cameras[k]));
    look(runs, run.objects, cameras.back(), options);
    result.frames.push_back(last_frame);
  }
  for (const SettingRun& r : runs) result.outcomes.push_back(r.outcome());
  return result;
}

std::vector<Outcome> over_all_scenes(const std::vector<SceneOutcomes>& scenes) {
  std::vector<Outcome> result;
  for (std::size_t i = 0; !scenes.empty() && i < scenes.front().outcomes.size(); ++i) {
    Outcome all;
    for (double Outcome::*time :
         {&Outcome::refine_ms, &Outcome::occlusion_ms, &Outcome::ms, &Outcome::draw_ms, &Outcome::triangles})
      all.*time = geometric_mean(scenes, i, time);
    for (const SceneOutcomes& scene : scenes) {
      const Outcome& one = scene.outcomes[i];
      all.pictures.insert(all.pictures.end(), one.pictures.begin(), one.pictures.end());
      all.hash = all.hash * 31 + one.hash;
    }
    all.measured = mean_of(all.pictures);
    result.push_back(std::move(all));
  }
  return result;
}

}  // namespace occlod::bench
