// Finds out whether an HLOD of the same scene would be faster than refinement by splits for the same quality.
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

// Holds the means over all views of what one way of drawing costs.
struct WayCost {
  std::string name;
  double triangles = 0.0;
  double ms = 0.0;            // to find out what to draw, on one core, without the device's time
  double draw_ms = 0.0;       // with our own rasteriser
  double depth_rms_px = 0.0;  // root mean square over the views that are compared
  double tolerance_px = 0.0;  // for an HLOD
  double queries = 0.0;       // to an HLOD's device

  [[nodiscard]] double triangle_ns() const { return 1e6 * draw_ms / triangles; }
};

// Tells for which renderers a way pays off: those that need less than below_ns, or more than above_ns, per triangle.
struct PaysWhere {
  double below_ns = 0.0;       // 0: none, infinite: all
  double above_ns = infinity;  // infinite: none

  static constexpr double infinity = std::numeric_limits<double>::infinity();
};
// Returns where `way` pays off more than `other`.
[[nodiscard]] PaysWhere pays_where(const WayCost& way, const WayCost& other);

// Takes views that were refined, and then draws them by HLODs.
class BesideHlod {
 public:
  // `objects` must outlive it. At most three of the `views`, evenly spread, are compared with the full mesh.
  BesideHlod(const std::vector<LoadedObject>& objects, int views);

  // Adds a view that has been refined.
  void add(const View& view, const Measurement& measurement);

  // Returns the costs of refinement.
  [[nodiscard]] WayCost splits() const;
  // Returns the costs of `strategy` with the largest tolerance whose error is no larger than that of refinement. The
  // strategy vfc makes no queries. The HLODs are of the same scene; the strategy needs no costs and no oracle.
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

// Returns the costs of splits, and of drawing all views by `vfc` and `coh`.
[[nodiscard]] std::vector<WayCost> costs_of_ways(const BesideHlod& beside, std::span<const hlod::PlacedHlod> placed);
[[nodiscard]] Json to_json(const std::vector<WayCost>& ways);
void print_ways(const std::vector<WayCost>& ways);

}  // namespace occlod::tool
