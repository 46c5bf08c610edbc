// Draws HLODs by one strategy, or by two beside each other, on the worker's thread when HLODs are open.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "hlod_devices.h"
#include "hlod_side.h"
#include "node_pictures.h"
#include "occlod/auto_refiner.h"
#include "occlod/device.h"
#include "occlod/device_costs.h"
#include "refine_worker.h"

namespace occlod::viewer {

class HlodBench {
 public:
  // Both references must outlive it.
  HlodBench(const MakeDevice& make, const std::optional<Calibration>& calibration)
      : make_(make), calibration_(calibration) {}

  // Fills the sides, the hash, the cache, the costs and goes_on. Reports meshes that are never loaded on standard
  // error. A job that asks for the same frame as the last one, and not for one more frame of it, gets that frame. The
  // job's objects are HLODs. Throws Error.
  void draw(RefinedFrame& frame);
  // Forgets all that is known of nodes, and the devices; call it after an error.
  void forget();

 private:
  struct Asked {
    Camera camera;
    hlod::TraverseOptions options;
    HlodDevice device = HlodDevice::gl;
    std::size_t most_triangles = 0;
    friend bool operator==(const Asked&, const Asked&) = default;
  };
  struct Side {
    hlod::Traverser traverser;
    std::optional<Asked> asked;              // for which the front was drawn
    std::shared_ptr<const HlodFront> front;  // the last one
    int repeats = 0;                         // equal fronts before it
    double tolerance_px = 0.0;               // with which it was drawn
    double too_fine_px = 0.0;                // a tolerance with which this view had too many triangles; 0: none
  };

  void place(const RefineJob& job);
  [[nodiscard]] HlodSide draw(Side& side, const RefineJob& job, hlod::Strategy strategy);
  [[nodiscard]] const hlod::Frame& draw_within(Side& side, const View& view, const Asked& asked, const RefineJob& job);
  // Returns the next tolerance for a side whose tolerance was raised; nothing where that would have too many triangles.
  [[nodiscard]] static std::optional<double> finer_px(const Side& side, double wanted_px);
  [[nodiscard]] hlod::TraverseOptions options_of(const RefineJob& job, hlod::Strategy strategy);
  [[nodiscard]] hlod::RenderDevice& device(HlodDevice device);
  // Returns nothing if the costs are unknown and not needed.
  [[nodiscard]] std::optional<hlod::DeviceCosts> costs(HlodDevice device, bool needed);
  [[nodiscard]] bool goes_on(const RefineJob& job);

  const MakeDevice& make_;
  const std::optional<Calibration>& calibration_;
  std::shared_ptr<const Objects> objects_;
  std::map<HlodDevice, std::unique_ptr<hlod::RenderDevice>> devices_;
  std::map<HlodDevice, hlod::DeviceCosts> costs_;
  std::vector<Side> sides_;
  NodePictures pictures_;
  std::uint64_t fronts_ = 0;
  int frames_at_rest_ = 0;
};

}  // namespace occlod::viewer
