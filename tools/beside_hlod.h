// Whether an HLOD of the same scene would be the faster way to the same picture than refinement by splits.
#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "accuracy.h"
#include "json_output.h"
#include "measurement.h"
#include "occlod/device.h"
#include "occlod/scene.h"
#include "occlod/traverser.h"
#include "occlod/view.h"

namespace occlod::tool {

// What one way to draw the views takes: means over all of them.
struct WayCost {
  std::string name;
  double triangles = 0.0;
  double ms = 0.0;            // to find out what to draw, on one core; what a device does is not in it
  double draw_ms = 0.0;       // by our own rasteriser
  double depth_rms_px = 0.0;  // root mean square over the views that are compared
  double tolerance_px = 0.0;  // of an HLOD
  double queries = 0.0;       // of an HLOD's device

  [[nodiscard]] double triangle_ns() const { return 1e6 * draw_ms / triangles; }
};

// For which renderers a way pays: those where a triangle costs less than below_ns, or more than above_ns, to draw.
struct PaysWhere {
  double below_ns = 0.0;       // 0: for none of them, infinite: for all
  double above_ns = infinity;  // infinite: for none of them

  static constexpr double infinity = std::numeric_limits<double>::infinity();
};
// Where `way` pays more than `other`.
[[nodiscard]] PaysWhere pays_where(const WayCost& way, const WayCost& other);

// Takes views as they have been refined, then draws them by HLODs.
class BesideHlod {
 public:
  // `objects` outlive it. `views`: how many there will be; of those, spread evenly, three are compared with the full
  // mesh at most.
  BesideHlod(const std::vector<LoadedObject>& objects, int views);

  // One more view, as it has been refined.
  void add(const View& view, const Measurement& measurement);

  // What the refinement took.
  [[nodiscard]] WayCost splits() const;
  // What the strategy takes, with the largest tolerance that leaves no larger error than the refinement did. Without a
  // query: vfc. The HLODs are of the same scene; the strategy needs no costs and no oracle.
  [[nodiscard]] WayCost hlod(std::span<const hlod::PlacedHlod> placed, hlod::Strategy strategy) const;

 private:
  struct Compared {
    View view;
    FullMeshPicture full;
    Compared(const std::vector<LoadedObject>& objects, const View& shown) : view(shown), full(objects, view) {}
  };
  [[nodiscard]] bool is_compared(std::size_t view) const;
  [[nodiscard]] double depth_rms_px(std::span<const hlod::PlacedHlod> placed, hlod::Strategy strategy,
                                    double tolerance_px) const;

  const std::vector<LoadedObject>& objects_;
  std::size_t view_count_;
  std::vector<View> views_;
  std::deque<Compared> compared_;
  WayCost splits_;  // sums
};

// Draws all by `vfc` and `coh` and says what that takes, beside the splits.
[[nodiscard]] std::vector<WayCost> costs_of_ways(const BesideHlod& beside, std::span<const hlod::PlacedHlod> placed);
[[nodiscard]] Json to_json(const std::vector<WayCost>& ways);
void print_ways(const std::vector<WayCost>& ways);

}  // namespace occlod::tool
