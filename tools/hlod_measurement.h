// Draws and times views of HLODs one after the other, as Measurement does for refinement by splits.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "front_mesh.h"
#include "occlod/device.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "occlod/traverser.h"
#include "occlod/view.h"

namespace occlod::tool {

// Holds medians over all repetitions.
struct HlodTimes {
  double traverse_ms = 0.0;  // traversal alone: the device takes no time
  double draw_ms = 0.0;      // the picture, by our own rasteriser
};

class HlodMeasurement {
 public:
  // What `placed` points to must outlive it. The strategy needs no costs.
  HlodMeasurement(std::span<const hlod::PlacedHlod> placed, const hlod::TraverseOptions& options);

  // Forgets earlier times.
  void begin();
  // Draws one more frame, to which the accessors then refer. The time that the device `software` takes to draw and to
  // answer is subtracted from the time of the traversal.
  void repeat(const View& view);

  [[nodiscard]] const hlod::FrameStats& stats() const { return stats_; }
  [[nodiscard]] std::uint64_t front_hash() const { return front_hash_; }
  [[nodiscard]] const ItemBuffer& items() const { return items_; }
  [[nodiscard]] std::span<const DrawObject> objects() const { return mesh_.objects(); }
  [[nodiscard]] HlodTimes times() const;  // since begin()

 private:
  std::span<const hlod::PlacedHlod> placed_;
  hlod::TraverseOptions options_;
  hlod::SoftwareDevice software_;
  hlod::Traverser traverser_;
  hlod::FrameStats stats_;
  std::uint64_t front_hash_ = 0;
  FrontMesh mesh_;
  ItemBuffer items_;
  std::vector<double> traverse_ms_, draw_ms_;
};

}  // namespace occlod::tool
