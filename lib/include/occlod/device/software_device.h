// The device `software`: our rasteriser, with exact counts at once. The picture and the truth for every other device.
#pragma once

#include <cstdint>
#include <memory>

#include "occlod/device/device.h"
#include "occlod/raster/item_buffer.h"

namespace occlod::hlod {

// How the software device draws.
struct SoftwareDeviceOptions {
  bool items = false;  // keep which triangle owns each pixel; drawing then takes about twice as long
};

// What has been done since begin_frame().
struct DeviceWork {
  std::uint64_t draws = 0;            // calls of draw()
  std::uint64_t triangles = 0;        // of them
  std::uint64_t fragments = 0;        // pixels covered, those of each triangle, whether they pass the depth test or not
  std::uint64_t boxes = 0;            // asked about
  std::uint64_t drawn_boxes = 0;      // of them, those that had to be drawn: others count all pixels or none
  std::uint64_t query_fragments = 0;  // pixels that the fronts of these cover, passing or not
};

// Draws at the resolution of the view with one sample at the middle of each pixel, in double precision up to the pixel.
// Every box is counted at once, each of its pixels once: available() is always true, wait() never waits. The same bits
// on every machine. end_frame() gives the times that this has really taken; the device is busy when it draws and asks,
// the calling thread always.
class SoftwareDevice final : public RenderDevice {
 public:
  // Allocates nothing before the first frame.
  explicit SoftwareDevice(const SoftwareDeviceOptions& options = {});
  ~SoftwareDevice() override;

  [[nodiscard]] std::string_view name() const noexcept override;
  void begin_frame(const View& view, std::span<const PlacedHlod> objects) override;
  void draw(const NodeDraw& draw) override;
  [[nodiscard]] QueryId ask(std::span<const BoxRef> boxes) override;
  [[nodiscard]] QueryId ask_each(std::span<const BoxRef> boxes) override;
  [[nodiscard]] bool available(QueryId query) override;
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId query) override;
  void visit(std::size_t nodes) override;
  FrameTimes end_frame() override;

  // Of this frame, or the last where it has ended.
  [[nodiscard]] const DeviceWork& work() const noexcept;
  // A copy of what is drawn, or has been where the frame has ended. O(pixels).
  [[nodiscard]] DepthBuffer depth() const;
  // What is drawn likewise; with SoftwareDeviceOptions::items. Triangle i of the frame's k-th draw is item i + the
  // triangles of the draws before it, in the order of the ranges.
  [[nodiscard]] const ItemBuffer& items() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod::hlod
