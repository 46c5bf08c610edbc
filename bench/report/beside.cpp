#include "report/beside.h"

#include "drawing.h"
#include "measurement.h"
#include "occlod/auto_refiner.h"
#include "occlod/scene.h"

namespace occlod::bench {

std::vector<tool::WayCost> compare_with_hlods(const SceneRun& run, const std::string& path,
                                              const SweepOptions& options) {
  const std::vector<LoadedHlod> hlods = load_hlods(run.description, run.description.file.parent_path());
  std::vector<Camera> cameras;
  for (int i = 0; i < options.bursts; ++i) {
    const Burst burst = burst_of(run, path, i, options);
    cameras.insert(cameras.end(), burst.cameras.begin(), burst.cameras.end());
  }
  tool::Measurement measurement(run.objects, tool::Following::frame_to_frame);
  AutoRefiner refiner(tool::refine_objects(run.objects));
  RefineOptions refine;
  refine.budget = options.knob_budget;
  tool::BesideHlod beside(run.objects, static_cast<int>(cameras.size()));
  for (const Camera& camera : cameras) {
    const View view(camera);
    measurement.begin();
    measurement.repeat(view, refine, refiner);
    beside.add(view, measurement);
  }
  return tool::costs_of_ways(beside, tool::placed_objects(hlods));
}

}  // namespace occlod::bench
