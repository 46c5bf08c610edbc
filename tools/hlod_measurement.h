// Draws views of HLODs, one after the other, and takes the time: what Measurement is to refinement by splits.
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

// Medians over all repetitions.
struct HlodTimes {
  double traverse_ms = 0.0;  // of the traversal alone: what draws and answers takes no time
  double draw_ms = 0.0;      // the picture, by our own rasteriser
};

class HlodMeasurement {
 public:
  // What `placed` points to outlives it. The strategy needs no costs.
  HlodMeasurement(std::span<const hlod::PlacedHlod> placed, const hlod::TraverseOptions& options);

  // Forgets earlier times.
  void begin();
  // One more frame; what the accessors tell is that of the last one. What the device `software` takes to draw and
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
